#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <string_view>

namespace flotsam {

/// Checks a mesh that a caller hands over: there are triangles, their corners are vertices of the mesh, and these are
/// finite. `what` begins the sentence of the std::invalid_argument ("a wall's mesh"). It costs a pass over the mesh;
/// check_mesh does more, and repairs.
void require_surface(const TriangleMesh& mesh, std::string_view what);

/// The same, and the triangles face outward: the volume is above zero.
void require_solid(const TriangleMesh& mesh, std::string_view what);

/// Whether the triangles' areas, as vectors, add up to nothing, as those of a closed surface do.
[[nodiscard]] bool is_closed(const TriangleMesh& mesh);

} // namespace flotsam
