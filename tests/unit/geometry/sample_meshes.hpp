#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace flotsam::test_meshes {

/// Closed box, outward.
inline TriangleMesh box(const Vec3d& low, const Vec3d& high)
{
    TriangleMesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.vertices.emplace_back((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
    mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    return mesh;
}

/// Box without its top.
inline TriangleMesh open_box(const Vec3d& low, const Vec3d& high)
{
    TriangleMesh mesh = box(low, high);
    mesh.triangles.resize(10);
    return mesh;
}

/// Closed shell of an open box, its walls and floor `thick`, inside the outer box; welded at its vertices.
inline TriangleMesh open_shell(const Vec3d& low, const Vec3d& high, double thick)
{
    TriangleMesh mesh = open_box(low, high);
    const Vec3d inset(thick, thick, 0.0);
    const TriangleMesh inner = open_box(low + inset + Vec3d(0, 0, thick), high - inset);
    mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
    for (const auto& t : inner.triangles) mesh.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    for (const auto& [a, b] : {std::array<int, 2>{4, 5}, {5, 7}, {7, 6}, {6, 4}}) { // the rim
        mesh.triangles.push_back({a, b, b + 8});
        mesh.triangles.push_back({a, b + 8, a + 8});
    }
    return mesh;
}

/// Closed sphere about the origin, `rings` from pole to pole.
inline TriangleMesh sphere(double radius, int rings)
{
    TriangleMesh mesh;
    const int around = 2 * rings;
    mesh.vertices.emplace_back(0.0, 0.0, radius);
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            const double theta = std::numbers::pi * i / rings, phi = 2.0 * std::numbers::pi * j / around;
            mesh.vertices.emplace_back(radius * std::sin(theta) * std::cos(phi),
                                       radius * std::sin(theta) * std::sin(phi), radius * std::cos(theta));
        }
    mesh.vertices.emplace_back(0.0, 0.0, -radius);
    const auto at = [&](int i, int j) { return 1 + (i - 1) * around + j % around; };
    const int south = static_cast<int>(mesh.vertices.size()) - 1;
    for (int j = 0; j < around; ++j) {
        mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
        for (int i = 1; i + 1 < rings; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
        }
        mesh.triangles.push_back({at(rings - 1, j), south, at(rings - 1, j + 1)});
    }
    return mesh;
}

/// Closed prism along y from -half to +half over a polygon in x and z, counter-clockwise as seen from -y. The ends are
/// fans about the first corner, which must see all others.
inline TriangleMesh prism(const std::vector<Eigen::Vector2d>& outline, double half)
{
    TriangleMesh mesh;
    const int n = static_cast<int>(outline.size());
    for (double y : {-half, half})
        for (const auto& p : outline) mesh.vertices.emplace_back(p.x(), y, p.y());
    for (int i = 0; i < n; ++i) {
        const int next = (i + 1) % n;
        mesh.triangles.push_back({i, next + n, next});
        mesh.triangles.push_back({i, i + n, next + n});
    }
    for (int i = 1; i + 1 < n; ++i) {
        mesh.triangles.push_back({0, i, i + 1});
        mesh.triangles.push_back({n, n + i + 1, n + i});
    }
    return mesh;
}

/// Closed disc across y.
inline TriangleMesh disc(double radius, int corners)
{
    std::vector<Eigen::Vector2d> outline;
    for (int k = 0; k < corners; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / corners;
        outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return prism(outline, 0.5);
}

/// An L two wide and high, of thickness one, `half` to both sides of y = 0; its inner corner is (1, 1).
inline TriangleMesh angle_bar(double size, double half)
{
    std::vector<Eigen::Vector2d> outline{{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}};
    for (auto& p : outline) p *= size;
    return prism(outline, half);
}

/// Closed cone with its tip, downward, at the origin and its flat top at z = height.
inline TriangleMesh cone(double radius, double height, int corners)
{
    TriangleMesh mesh;
    mesh.vertices = {Vec3d::Zero(), Vec3d(0, 0, height)};
    for (int k = 0; k < corners; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / corners;
        mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
    for (int k = 0; k < corners; ++k) {
        const int a = 2 + k, b = 2 + (k + 1) % corners;
        mesh.triangles.push_back({0, b, a});
        mesh.triangles.push_back({1, a, b});
    }
    return mesh;
}

/// Volume by the divergence theorem.
inline double volume(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        sum += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2))) / 6.0;
    return sum;
}

} // namespace flotsam::test_meshes
