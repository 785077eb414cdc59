#include "flotsam/geometry/triangle_mesh.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace flotsam {

namespace {

using Triangle = std::array<int, 3>;

int part_count(const TriangleMesh& mesh)
{
    int count = static_cast<int>(mesh.part_names.size());
    for (const int part : mesh.part_of_triangle) count = std::max(count, part + 1);
    return mesh.empty() ? count : std::max(count, 1);
}

/// Fills in what a mesh of one part may leave empty.
void name_every_part(TriangleMesh& mesh)
{
    mesh.part_names.resize(static_cast<std::size_t>(part_count(mesh)));
    mesh.part_of_triangle.resize(mesh.triangles.size(), 0);
}

/// Midpoints of the edges that are too long, each made once.
class Midpoints {
  public:
    Midpoints(std::vector<Vec3d>& vertices, double max_edge) : vertices_(vertices), max_sq_(max_edge * max_edge) {}

    /// Index of the midpoint, or -1 for an edge that is short enough.
    int of(int a, int b)
    {
        const Vec3d& p = vertices_[static_cast<std::size_t>(a)];
        const Vec3d& q = vertices_[static_cast<std::size_t>(b)];
        if (!((p - q).squaredNorm() > max_sq_)) return -1;
        const auto [low, high] = std::minmax(a, b);
        const auto key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
        const auto [entry, is_new] = index_.try_emplace(key, static_cast<int>(vertices_.size()));
        if (is_new) vertices_.emplace_back(0.5 * (p + q));
        return entry->second;
    }

  private:
    std::vector<Vec3d>& vertices_;
    double max_sq_;
    std::unordered_map<std::uint64_t, int> index_;
};

/// The same triangle with its longest edge first, which keeps every new edge below 0.87 of it.
Triangle longest_edge_first(const Triangle& t, const std::vector<Vec3d>& vertices)
{
    const auto length_sq = [&](std::size_t k) {
        return (vertices[static_cast<std::size_t>(t[k])] - vertices[static_cast<std::size_t>(t[(k + 1) % 3])])
            .squaredNorm();
    };
    std::size_t k = 0;
    if (length_sq(1) > length_sq(k)) k = 1;
    if (length_sq(2) > length_sq(k)) k = 2;
    return {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
}

/// Appends the pieces of one triangle; an edge is split or not by its own length alone, so that neighbours agree.
void split(const Triangle& triangle, TriangleMesh& mesh, Midpoints& midpoints, std::vector<Triangle>& pieces)
{
    const auto [a, b, c] = longest_edge_first(triangle, mesh.vertices);
    const int ab = midpoints.of(a, b);
    const int bc = midpoints.of(b, c);
    const int ca = midpoints.of(c, a);
    if (ab < 0) {
        pieces.push_back(triangle);
    } else if (bc >= 0 && ca >= 0) {
        pieces.insert(pieces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    } else {
        if (ca >= 0)
            pieces.insert(pieces.end(), {{a, ab, ca}, {ca, ab, c}});
        else
            pieces.push_back({a, ab, c});
        if (bc >= 0)
            pieces.insert(pieces.end(), {{ab, b, bc}, {ab, bc, c}});
        else
            pieces.push_back({ab, b, c});
    }
}

} // namespace

Aabb bounds(const TriangleMesh& mesh)
{
    Aabb box;
    for (const Vec3d& vertex : mesh.vertices) box.extend(vertex);
    return box;
}

TriangleMesh transformed(TriangleMesh mesh, const Pose& pose)
{
    const Mat3d rotation = pose.orientation.toRotationMatrix();
    for (Vec3d& vertex : mesh.vertices) vertex = pose.position + rotation * vertex;
    return mesh;
}

TriangleMesh flipped(TriangleMesh mesh)
{
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    return mesh;
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b)
{
    if (b.empty() && b.vertices.empty()) return a;
    if (a.empty() && a.vertices.empty()) return b;
    TriangleMesh second = b;
    name_every_part(a);
    name_every_part(second);
    const auto first_vertex = static_cast<int>(a.vertices.size());
    const auto first_part = static_cast<int>(a.part_names.size());
    a.vertices.insert(a.vertices.end(), second.vertices.begin(), second.vertices.end());
    for (const Triangle& t : second.triangles)
        a.triangles.push_back({t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex});
    for (const int part : second.part_of_triangle) a.part_of_triangle.push_back(part + first_part);
    a.part_names.insert(a.part_names.end(), second.part_names.begin(), second.part_names.end());
    return a;
}

TriangleMesh refined(TriangleMesh mesh, double max_edge)
{
    require(max_edge > 0.0, "max_edge must be > 0 m", max_edge);
    // An infinite edge would be halved forever.
    for (const Vec3d& vertex : mesh.vertices) require(vertex.allFinite(), "vertices must be finite");
    for (bool is_fine = false; !is_fine;) {
        Midpoints midpoints(mesh.vertices, max_edge);
        std::vector<Triangle> pieces;
        std::vector<int> part_of_piece;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            split(mesh.triangles[t], mesh, midpoints, pieces);
            if (!mesh.part_of_triangle.empty()) part_of_piece.resize(pieces.size(), mesh.part_of_triangle[t]);
        }
        is_fine = pieces.size() == mesh.triangles.size();
        mesh.triangles = std::move(pieces);
        mesh.part_of_triangle = std::move(part_of_piece);
    }
    return mesh;
}

} // namespace flotsam
