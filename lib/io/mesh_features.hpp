#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <vector>

namespace flotsam {

/// A normal for each corner of each triangle (3 per triangle): mean over the triangles around the vertex that are bent
/// by less than `crease_deg` against this one, so that round things look round and edges stay sharp.
[[nodiscard]] std::vector<Vec3> corner_normals(const TriangleMesh& mesh, double crease_deg);

/// Pairs of vertices: edges with one triangle only, or bent by more than `crease_deg`.
[[nodiscard]] std::vector<std::array<int, 2>> feature_edges(const TriangleMesh& mesh, double crease_deg);

} // namespace flotsam
