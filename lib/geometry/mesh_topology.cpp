#include "geometry/mesh_topology.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace flotsam {
namespace {

std::vector<int> weld_by_place(const std::vector<Vec3d>& vertices)
{
    std::vector<int> order(vertices.size()), first(vertices.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int v) {
        const Vec3d& p = vertices[static_cast<std::size_t>(v)];
        return std::tuple(p.x(), p.y(), p.z());
    };
    std::sort(order.begin(), order.end(), [&](int v, int w) { return std::pair(key(v), v) < std::pair(key(w), w); });
    for (std::size_t k = 0; k < order.size(); ++k) {
        const bool same = k > 0 && key(order[k]) == key(order[k - 1]);
        first[static_cast<std::size_t>(order[k])] = same ? first[static_cast<std::size_t>(order[k - 1])] : order[k];
    }
    return first;
}

struct Side {
    int low, high, triangle, corner;
};

} // namespace

MeshTopology topology(const TriangleMesh& mesh)
{
    MeshTopology result;
    result.first_at_place = weld_by_place(mesh.vertices);
    const auto vertex = [&](std::size_t t, int k) {
        return result.first_at_place[static_cast<std::size_t>(mesh.triangles[t][static_cast<std::size_t>(k % 3)])];
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(vertex(t, k), vertex(t, k + 1));
            if (low != high) sides.push_back({low, high, static_cast<int>(t), k});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& r) {
        return std::tie(s.low, s.high, s.triangle, s.corner) < std::tie(r.low, r.high, r.triangle, r.corner);
    });

    result.boundary.assign(mesh.triangles.size(), {false, false, false});
    result.on_boundary.assign(mesh.vertices.size(), false);
    for (std::size_t k = 0; k < sides.size();) {
        std::size_t end = k + 1;
        while (end < sides.size() && sides[end].low == sides[k].low && sides[end].high == sides[k].high) ++end;
        MeshEdge edge{sides[k].low, sides[k].high, sides[k].triangle, -1, -1, static_cast<int>(end - k)};
        if (edge.triangles >= 2) {
            edge.right = sides[k + 1].triangle;
            edge.apex = vertex(static_cast<std::size_t>(edge.right), sides[k + 1].corner + 2);
        } else {
            result.boundary[static_cast<std::size_t>(edge.left)][static_cast<std::size_t>(sides[k].corner)] = true;
            result.on_boundary[static_cast<std::size_t>(edge.a)] = true;
            result.on_boundary[static_cast<std::size_t>(edge.b)] = true;
        }
        result.edges.push_back(edge);
        k = end;
    }
    return result;
}

} // namespace flotsam
