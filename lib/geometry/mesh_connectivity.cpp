#include "geometry/mesh_connectivity.hpp"

#include <algorithm>
#include <tuple>

namespace flotsam {

namespace {

/// One triangle's use of one edge.
struct EdgeUse {
    int low;
    int high;
    int part;
    int triangle;
    int corner;
    bool is_upward; ///< from low to high

    [[nodiscard]] bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
    bool operator<(const EdgeUse& other) const
    {
        return std::tie(low, high, part, triangle, corner) <
               std::tie(other.low, other.high, other.part, other.triangle, other.corner);
    }
};

std::vector<EdgeUse> sorted_edge_uses(const TriangleMesh& mesh)
{
    std::vector<EdgeUse> uses;
    uses.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = mesh.triangles[t][static_cast<std::size_t>(k)];
            const int b = mesh.triangles[t][static_cast<std::size_t>((k + 1) % 3)];
            const int part = mesh.part_of_triangle.empty() ? 0 : mesh.part_of_triangle[t];
            uses.push_back({std::min(a, b), std::max(a, b), part, static_cast<int>(t), k, a < b});
        }
    std::sort(uses.begin(), uses.end());
    return uses;
}

using UseIterator = std::vector<EdgeUse>::const_iterator;

bool is_two_per_part(UseIterator begin, UseIterator end)
{
    for (auto use = begin; use != end;) {
        const auto next = std::find_if(use, end, [&](const EdgeUse& other) { return other.part != use->part; });
        if (next - use != 2) return false;
        use = next;
    }
    return true;
}

void link(TriangleAdjacency& topology, const EdgeUse& a, const EdgeUse& b)
{
    const bool faces_same = a.is_upward != b.is_upward;
    const auto neighbour_of = [&](const EdgeUse& use) -> TriangleAdjacency::Neighbour& {
        return topology.neighbours[static_cast<std::size_t>(use.triangle)][static_cast<std::size_t>(use.corner)];
    };
    neighbour_of(a) = {b.triangle, faces_same};
    neighbour_of(b) = {a.triangle, faces_same};
}

/// Fills one part from its first triangle on, breadth first.
void flood(const TriangleMesh& mesh, const TriangleAdjacency& topology, int seed, std::vector<char>& is_seen,
           ConnectedParts& parts)
{
    std::vector<int> part{seed};
    bool is_closed = true;
    is_seen[static_cast<std::size_t>(seed)] = 1;
    for (std::size_t at = 0; at < part.size(); ++at) {
        const auto t = static_cast<std::size_t>(part[at]);
        for (std::size_t k = 0; k < 3; ++k) {
            const TriangleAdjacency::Neighbour& across = topology.neighbours[t][k];
            if (across.triangle < 0) {
                is_closed = false;
                continue;
            }
            const auto other = static_cast<std::size_t>(across.triangle);
            const char wanted = across.faces_same ? parts.is_flipped[t] : static_cast<char>(!parts.is_flipped[t]);
            if (is_seen[other] == 0) {
                is_seen[other] = 1;
                parts.is_flipped[other] = wanted;
                part.push_back(across.triangle);
            } else if (parts.is_flipped[other] != wanted && !parts.not_orientable) {
                parts.not_orientable = VertexPair{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]};
            }
        }
    }
    std::sort(part.begin(), part.end());
    parts.triangles.push_back(std::move(part));
    parts.is_closed.push_back(static_cast<char>(is_closed));
}

} // namespace

TriangleAdjacency triangle_adjacency(const TriangleMesh& mesh)
{
    TriangleAdjacency topology;
    topology.neighbours.resize(mesh.triangles.size());
    const std::vector<EdgeUse> uses = sorted_edge_uses(mesh);
    for (auto begin = uses.begin(); begin != uses.end();) {
        const auto end = std::find_if(begin, uses.end(), [&](const EdgeUse& use) { return !use.same_edge(*begin); });
        const auto count = end - begin;
        if (count == 1)
            topology.open_edges.push_back({begin->low, begin->high});
        else if (count == 2 || is_two_per_part(begin, end))
            for (auto use = begin; use != end; use += 2) link(topology, *use, *(use + 1));
        else
            topology.crowded_edges.push_back({begin->low, begin->high});
        begin = end;
    }
    return topology;
}

ConnectedParts connected_parts(const TriangleMesh& mesh, const TriangleAdjacency& topology)
{
    ConnectedParts parts;
    parts.is_flipped.resize(mesh.triangles.size(), 0);
    std::vector<char> is_seen(mesh.triangles.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (is_seen[t] == 0) flood(mesh, topology, static_cast<int>(t), is_seen, parts);
    return parts;
}

TriangleMesh with_triangles(const TriangleMesh& mesh, const std::vector<int>& triangles)
{
    TriangleMesh result;
    result.vertices.reserve(3 * triangles.size());
    for (const int t : triangles) {
        const auto first = static_cast<int>(result.vertices.size());
        for (int k = 0; k < 3; ++k) result.vertices.push_back(mesh.corner(static_cast<std::size_t>(t), k));
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

} // namespace flotsam
