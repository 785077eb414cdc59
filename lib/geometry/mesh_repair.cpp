#include "mesh_repair.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>

namespace flotsam {

namespace {

/// Finds vertices by place: cells as wide as the tolerance, so that a match lies in one of 27.
class VertexGrid {
  public:
    VertexGrid(const Vec3d& origin, double cell) : origin_(origin), cell_(cell) {}

    /// Index of the first vertex added within a cell's width of `point`, or -1.
    [[nodiscard]] int find(const Vec3d& point, const std::vector<Vec3d>& vertices) const
    {
        const Cell home = cell_of(point);
        int first = -1;
        for (int k = 0; k < 27; ++k) {
            const auto entry = cells_.find({home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1});
            if (entry == cells_.end()) continue;
            for (const int v : entry->second)
                if ((vertices[static_cast<std::size_t>(v)] - point).norm() <= cell_ && (first < 0 || v < first))
                    first = v;
        }
        return first;
    }

    void add(int vertex, const Vec3d& point) { cells_[cell_of(point)].push_back(vertex); }

  private:
    using Cell = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Cell& c) const
        {
            return static_cast<std::size_t>(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
        }
    };

    [[nodiscard]] Cell cell_of(const Vec3d& point) const
    {
        const Vec3d at = (point - origin_) / cell_;
        return {std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
    }

    Vec3d origin_;
    double cell_;
    std::unordered_map<Cell, std::vector<int>, Hash> cells_;
};

} // namespace

Weld weld_vertices(TriangleMesh& mesh, double tolerance)
{
    Weld weld;
    VertexGrid grid(bounds(mesh).min, tolerance > 0.0 ? tolerance : 1.0); // no extent: all are at one place
    std::vector<Vec3d> kept;
    std::vector<int> index;
    for (const Vec3d& vertex : mesh.vertices) {
        int at = grid.find(vertex, kept);
        if (at < 0) {
            at = static_cast<int>(kept.size());
            kept.push_back(vertex);
            grid.add(at, vertex);
        } else {
            const double distance = (kept[static_cast<std::size_t>(at)] - vertex).norm();
            ++weld.merged;
            if (distance > 0.0) ++weld.merged_apart;
            weld.farthest = std::max(weld.farthest, distance);
        }
        index.push_back(at);
    }
    for (auto& triangle : mesh.triangles)
        for (int& v : triangle) v = index[static_cast<std::size_t>(v)];
    mesh.vertices = std::move(kept);
    return weld;
}

int drop_degenerate_triangles(TriangleMesh& mesh)
{
    std::set<std::array<int, 4>> seen;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<int, 3> corners = mesh.triangles[t];
        std::sort(corners.begin(), corners.end());
        const int part = mesh.part_of_triangle.empty() ? 0 : mesh.part_of_triangle[t];
        if (corners[0] == corners[1] || corners[1] == corners[2]) continue;
        if (!seen.insert({corners[0], corners[1], corners[2], part}).second) continue;
        mesh.triangles[kept] = mesh.triangles[t];
        if (!mesh.part_of_triangle.empty()) mesh.part_of_triangle[kept] = part;
        ++kept;
    }
    const auto dropped = static_cast<int>(mesh.triangles.size() - kept);
    mesh.triangles.resize(kept);
    if (!mesh.part_of_triangle.empty()) mesh.part_of_triangle.resize(kept);
    return dropped;
}

void drop_unused_vertices(TriangleMesh& mesh)
{
    std::vector<int> index(mesh.vertices.size(), -1);
    for (const auto& triangle : mesh.triangles)
        for (const int v : triangle) index[static_cast<std::size_t>(v)] = 0;
    int kept = 0;
    for (std::size_t v = 0; v < index.size(); ++v) {
        if (index[v] < 0) continue;
        mesh.vertices[static_cast<std::size_t>(kept)] = mesh.vertices[v];
        index[v] = kept++;
    }
    mesh.vertices.resize(static_cast<std::size_t>(kept));
    for (auto& triangle : mesh.triangles)
        for (int& v : triangle) v = index[static_cast<std::size_t>(v)];
}

} // namespace flotsam
