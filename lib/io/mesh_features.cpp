#include "io/mesh_features.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace flotsam {

namespace {

/// Normals with the length of twice the triangle's area.
std::vector<Vec3d> area_normals(const TriangleMesh& mesh)
{
    std::vector<Vec3d> normals(mesh.triangles.size());
    for (std::size_t t = 0; t < normals.size(); ++t) {
        const Vec3d a = mesh.corner(t, 0);
        normals[t] = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a);
    }
    return normals;
}

double cosine(double degrees)
{
    return std::cos(degrees * std::numbers::pi / 180.0);
}

bool bent_less(const Vec3d& a, const Vec3d& b, double cos_limit)
{
    return a.dot(b) > cos_limit * a.norm() * b.norm();
}

/// Triangles around each vertex, as CSR.
struct Fans {
    std::vector<std::size_t> begin, triangle;

    explicit Fans(const TriangleMesh& mesh) : begin(mesh.vertices.size() + 1), triangle(3 * mesh.triangles.size())
    {
        for (const auto& corners : mesh.triangles) {
            for (const int v : corners) ++begin[static_cast<std::size_t>(v) + 1];
        }
        for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
        std::vector<std::size_t> next(begin.begin(), begin.end());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            for (const int v : mesh.triangles[t]) triangle[next[static_cast<std::size_t>(v)]++] = t;
        }
    }
};

} // namespace

std::vector<Vec3> corner_normals(const TriangleMesh& mesh, double crease_deg)
{
    const std::vector<Vec3d> flat = area_normals(mesh);
    const Fans fans(mesh);
    const double cos_limit = cosine(crease_deg);
    std::vector<Vec3> normals;
    normals.reserve(3 * flat.size());
    for (std::size_t t = 0; t < flat.size(); ++t) {
        for (const int corner : mesh.triangles[t]) {
            const auto v = static_cast<std::size_t>(corner);
            Vec3d sum = flat[t];
            for (std::size_t k = fans.begin[v]; k < fans.begin[v + 1]; ++k) {
                const std::size_t other = fans.triangle[k];
                if (other != t && bent_less(flat[t], flat[other], cos_limit)) sum += flat[other];
            }
            normals.emplace_back(sum.normalized().cast<Scalar>());
        }
    }
    return normals;
}

std::vector<std::array<int, 2>> feature_edges(const TriangleMesh& mesh, double crease_deg)
{
    const std::vector<Vec3d> flat = area_normals(mesh);
    std::map<std::array<int, 2>, std::vector<std::size_t>> triangles_of_edge;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = mesh.triangles[t][k];
            const int b = mesh.triangles[t][(k + 1) % 3];
            triangles_of_edge[{std::min(a, b), std::max(a, b)}].emplace_back(t);
        }
    }
    const double cos_limit = cosine(crease_deg);
    std::vector<std::array<int, 2>> edges;
    for (const auto& [edge, around] : triangles_of_edge) {
        if (around.size() != 2 || !bent_less(flat[around[0]], flat[around[1]], cos_limit)) edges.push_back(edge);
    }
    return edges;
}

} // namespace flotsam
