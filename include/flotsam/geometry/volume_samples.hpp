#pragma once

#include "flotsam/geometry/surface_query.hpp"

#include <vector>

namespace flotsam {

/// Lattice points that fill a box with round(volume / spacing^3) points (in 2-D: area / spacing^2, plane y = 0; the
/// box's y extent does not matter): whole layers with a lattice stretched to the box's width, the top layer filled in
/// part, evenly, so that the volume is what was asked for to one point.
[[nodiscard]] std::vector<Vec3d> fill_box(const Aabb& box, double spacing, int dimensions);

/// Points of the cubic lattice of `spacing` that lie inside a closed mesh (in 2-D: in its cut at y = 0). Along each
/// axis the lattice has a point or the middle between two in the middle of the mesh, whichever brings the number of
/// points closest to the volume; what is left is of the order of the surface's roughness.
[[nodiscard]] std::vector<Vec3d> fill_mesh(const SurfaceQuery& closed, double spacing, int dimensions);

} // namespace flotsam
