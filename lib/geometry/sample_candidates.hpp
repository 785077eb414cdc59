#pragma once

#include "geometry/offset_surface.hpp"
#include "geometry/sample_rods.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace flotsam {

/// Dense random points of an offset surface.
struct SampleCandidates {
    std::vector<OffsetPoint> points;
    double area_each = 0.0; ///< of the surface that each stands for [m^2]
    std::vector<BarePoint> bare;
    std::array<double, 6> cut{}; ///< length along which the region's sides -x +x -y +y -z +z cut the mesh [m]
};

/// About `per_area` candidates a square metre: below the triangles, and where the solid bends around an edge or a
/// vertex by more than 180 degrees, on arcs and caps around it. Of the mesh within `region` alone.
[[nodiscard]] SampleCandidates sample_candidates(const OffsetSurface& offset, double per_area, std::uint64_t seed,
                                                 const Aabb& region);

/// Leaves of the segment a b what lies in the box; false where nothing does.
[[nodiscard]] bool clip_segment(const Aabb& box, Vec3d& a, Vec3d& b);

} // namespace flotsam
