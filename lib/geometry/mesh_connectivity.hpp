#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <optional>
#include <vector>

namespace flotsam {

using VertexPair = std::array<int, 2>; ///< vertices

/// Which triangle lies across each edge.
struct TriangleAdjacency {
    struct Neighbour {
        int triangle = -1;      ///< -1: none
        bool faces_same = true; ///< walks the shared edge the other way round, as it should
    };
    std::vector<std::array<Neighbour, 3>> neighbours; ///< across the edge from corner k to corner k + 1
    std::vector<VertexPair> open_edges;               ///< of one triangle
    std::vector<VertexPair> crowded_edges;            ///< of more than two; they link no triangles
};

/// An edge with more than two triangles is no trouble where parts of the file only touch each other: if each part has
/// two of the triangles, they are neighbours.
[[nodiscard]] TriangleAdjacency triangle_adjacency(const TriangleMesh& mesh);

/// Triangles that hang together across edges.
struct ConnectedParts {
    std::vector<std::vector<int>> triangles;  ///< of each part, rising; parts by their first triangle
    std::vector<char> is_flipped;             ///< of each triangle, to face as the first one of its part
    std::vector<char> is_closed;              ///< of each part
    std::optional<VertexPair> not_orientable; ///< an edge whose two triangles cannot agree
};

[[nodiscard]] ConnectedParts connected_parts(const TriangleMesh& mesh, const TriangleAdjacency& topology);

/// Some triangles of a mesh, their corners unshared: enough for bounds and volume, and cheap for a thousand parts.
[[nodiscard]] TriangleMesh with_triangles(const TriangleMesh& mesh, const std::vector<int>& triangles);

} // namespace flotsam
