#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <array>
#include <vector>

namespace flotsam {

/// An edge of a mesh whose vertices were welded by place.
struct MeshEdge {
    int a = -1, b = -1;        ///< vertices, the first of those at the same place
    int left = -1, right = -1; ///< triangles; right = -1 at a boundary
    int apex = -1;             ///< of `right`: its vertex off the edge
    int triangles = 0;         ///< that share it
};

/// Who neighbours whom in a mesh, vertices at exactly the same place being one.
struct MeshTopology {
    std::vector<int> first_at_place; ///< per vertex
    std::vector<MeshEdge> edges;
    std::vector<std::array<bool, 3>> boundary; ///< per triangle: is the edge from corner k to k + 1 a boundary?
    std::vector<bool> on_boundary;             ///< per vertex, as first_at_place names it
};

[[nodiscard]] MeshTopology topology(const TriangleMesh& mesh);

} // namespace flotsam
