#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <optional>
#include <vector>

namespace flotsam {

/// A place where a surface cuts another one, or itself.
struct Crossing {
    int triangle_a = -1;
    int triangle_b = -1;
    Vec3d place = Vec3d::Zero();
};

struct Crossings {
    std::optional<Crossing> between_parts; ///< the first one found
    std::optional<Crossing> inside_a_part;
};

/// Looks for triangles that go through each other by more than `tolerance` [m], or lie on each other facing the same
/// way. Surfaces that only touch (a box standing on a box) are no crossing. Needs part_of_triangle.
[[nodiscard]] Crossings find_crossings(const TriangleMesh& mesh, double tolerance, bool inside_parts_too);

/// Where one closed part lies with respect to another one.
struct PartSide {
    int inside = 0;  ///< of the points tried
    int outside = 0; ///< points within `tolerance` of the other's surface count for neither
    Vec3d place_inside = Vec3d::Zero();
};

/// Tries some triangles' centres of `part` against `other`: closed, facing outward. Lists of triangles of one mesh.
[[nodiscard]] PartSide side_of_part(const TriangleMesh& mesh, const std::vector<int>& part,
                                    const std::vector<int>& other, double tolerance);

} // namespace flotsam
