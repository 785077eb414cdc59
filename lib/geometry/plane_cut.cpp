#include "geometry/plane_cut.hpp"

#include "geometry/mesh_topology.hpp"

#include <algorithm>
#include <map>

namespace flotsam {
namespace {

using Crossing = std::pair<int, int>; ///< the edge of the mesh that crosses the plane there: lower vertex first

/// Nodes (crossings) joined by directed segments, one a triangle.
struct CutGraph {
    std::vector<Vec2d> points;
    std::vector<std::vector<int>> next; ///< per node
    std::vector<int> incoming;          ///< per node, how many segments end there

    [[nodiscard]] bool passes(int node) const
    {
        return next[static_cast<std::size_t>(node)].size() == 1 && incoming[static_cast<std::size_t>(node)] == 1;
    }
};

CutGraph cut_triangles(const TriangleMesh& mesh)
{
    CutGraph graph;
    const std::vector<int> first = topology(mesh).first_at_place;
    std::map<Crossing, int> node_of;
    const auto node = [&](int v, int w) {
        const Crossing key = std::minmax(v, w);
        const auto [place, is_new] = node_of.try_emplace(key, static_cast<int>(graph.points.size()));
        if (is_new) {
            const Vec3d &p = mesh.vertices[static_cast<std::size_t>(key.first)],
                        &q = mesh.vertices[static_cast<std::size_t>(key.second)];
            const double along = p.y() / (p.y() - q.y());
            graph.points.emplace_back(p.x() + along * (q.x() - p.x()), p.z() + along * (q.z() - p.z()));
            graph.next.emplace_back();
            graph.incoming.push_back(0);
        }
        return place->second;
    };
    const auto above = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].y() >= 0.0; };
    for (const auto& triangle : mesh.triangles) {
        int up = -1, down = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const int v = first[static_cast<std::size_t>(triangle[k])];
            const int w = first[static_cast<std::size_t>(triangle[(k + 1) % 3])];
            if (above(v) != above(w)) (above(w) ? up : down) = node(v, w);
        }
        if (up < 0 || down < 0) continue;
        graph.next[static_cast<std::size_t>(up)].push_back(down);
        ++graph.incoming[static_cast<std::size_t>(down)];
    }
    return graph;
}

/// Points that lie on each other come from vertices in the plane.
void drop_doubles(CutLine& line, double tolerance)
{
    std::vector<Vec2d> kept;
    for (const Vec2d& p : line.points)
        if (kept.empty() || (p - kept.back()).norm() > tolerance) kept.push_back(p);
    if (line.closed && kept.size() > 1 && (kept.front() - kept.back()).norm() <= tolerance) kept.pop_back();
    line.points = std::move(kept);
}

} // namespace

std::vector<CutLine> cut_at_y0(const TriangleMesh& mesh)
{
    CutGraph graph = cut_triangles(mesh);
    double largest = 0.0;
    for (const Vec2d& p : graph.points) largest = std::max(largest, p.cwiseAbs().maxCoeff());

    std::vector<CutLine> lines;
    const auto walk = [&](int start) {
        CutLine line;
        int node = start;
        do {
            line.points.push_back(graph.points[static_cast<std::size_t>(node)]);
            auto& next = graph.next[static_cast<std::size_t>(node)];
            node = next.back();
            next.pop_back();
        } while (node != start && graph.incoming[static_cast<std::size_t>(node)] == 1 &&
                 graph.next[static_cast<std::size_t>(node)].size() == 1);
        line.closed = node == start;
        if (!line.closed) line.points.push_back(graph.points[static_cast<std::size_t>(node)]);
        drop_doubles(line, 1e-10 * largest);
        if (line.points.size() >= (line.closed ? 3U : 2U)) lines.push_back(std::move(line));
    };
    const int nodes = static_cast<int>(graph.points.size());
    std::vector<int> ends; // lines begin where they do not simply pass; what is left then is closed
    for (int node = 0; node < nodes; ++node)
        if (!graph.passes(node)) ends.push_back(node);
    for (int node : ends)
        while (!graph.next[static_cast<std::size_t>(node)].empty()) walk(node);
    for (int node = 0; node < nodes; ++node)
        while (!graph.next[static_cast<std::size_t>(node)].empty()) walk(node);
    return lines;
}

TriangleMesh ribbon(const std::vector<CutLine>& lines, double half)
{
    TriangleMesh mesh;
    const Vec3d across(0.0, half, 0.0);
    for (const CutLine& line : lines) {
        const int first = static_cast<int>(mesh.vertices.size()), count = static_cast<int>(line.points.size());
        for (const Vec2d& p : line.points) {
            mesh.vertices.emplace_back(in_space(p) - across);
            mesh.vertices.emplace_back(in_space(p) + across);
        }
        for (int k = 0; k < count - (line.closed ? 0 : 1); ++k) {
            const int p = first + 2 * k, q = first + 2 * ((k + 1) % count);
            mesh.triangles.push_back({p, q + 1, q});
            mesh.triangles.push_back({p, p + 1, q + 1});
        }
    }
    return mesh;
}

double enclosed_area(const std::vector<CutLine>& lines)
{
    double area = 0.0;
    for (const CutLine& line : lines) {
        if (!line.closed) continue;
        for (std::size_t k = 0; k < line.points.size(); ++k) {
            const Vec2d &p = line.points[k], &q = line.points[(k + 1) % line.points.size()];
            area += 0.5 * (p.x() * q.y() - p.y() * q.x());
        }
    }
    return area;
}

} // namespace flotsam
