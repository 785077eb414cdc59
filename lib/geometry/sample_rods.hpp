#pragma once

#include "geometry/offset_surface.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// A point of the mesh that has no offset point straight below.
struct BarePoint {
    Vec3d base = Vec3d::Zero();
    Vec3d inward = Vec3d::Zero(); ///< unit, the direction that was tried
};

/// Parts that are thin in two directions or more (rods, specks) have no layer: adds samples at the deepest points
/// below bare points that lie far from every sample.
void sample_rods(std::vector<OffsetPoint>& samples, std::span<const BarePoint> bare, const OffsetSurface& offset,
                 double spacing);

[[nodiscard]] std::vector<Vec3d> positions_of(std::span<const OffsetPoint> points);

} // namespace flotsam
