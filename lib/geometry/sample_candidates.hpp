#pragma once

#include "geometry/offset_surface.hpp"
#include "geometry/sample_rods.hpp"

#include <cstdint>
#include <vector>

namespace flotsam {

/// Dense random points of an offset surface.
struct SampleCandidates {
    std::vector<OffsetPoint> points;
    double area_each = 0.0; ///< of the surface that each stands for [m^2]
    std::vector<BarePoint> bare;
};

/// About `per_area` candidates a square metre: below the triangles, and where the solid bends around an edge or a
/// vertex by more than 180 degrees, on arcs and caps around it.
[[nodiscard]] SampleCandidates sample_candidates(const OffsetSurface& offset, double per_area, std::uint64_t seed);

} // namespace flotsam
