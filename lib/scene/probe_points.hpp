#pragma once

#include "flotsam/geometry/surface_query.hpp"

#include <vector>

namespace flotsam::scene {

// Points of solids that are asked for where they lie in other solids.

/// Points of a surface about `spacing` [m] apart; further apart where that would be more than 64 in its length.
[[nodiscard]] std::vector<Vec3d> surface_points(const TriangleMesh& mesh, double spacing);

/// Points spread evenly over a box, none on its sides.
[[nodiscard]] std::vector<Vec3d> grid_in(const Aabb& box);

/// Points spread over a solid, all more than `depth` [m] below its surface: what lies in its place, face on face with
/// it, has no point of the surface inside, but these.
[[nodiscard]] std::vector<Vec3d> inner_points(const SurfaceQuery& solid, double depth);

} // namespace flotsam::scene
