#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace flotsam {

/// A part of a triangle.
struct TrianglePiece {
    Vec3d center = Vec3d::Zero();
    Vec3d normal = Vec3d::Zero(); ///< unit, of the triangle
    double area = 0.0;            ///< [m^2]
    std::size_t triangle = 0;
};

/// Each triangle in n^2 equal parts, n so that none has an edge longer than `max_edge` [m], but at most `most` of them
/// along an edge; triangles without area have none.
[[nodiscard]] inline std::vector<TrianglePiece> pieces_of(const TriangleMesh& mesh, double max_edge, int most = 1 << 30)
{
    std::vector<TrianglePiece> pieces;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d a = mesh.corner(t, 0), u = mesh.corner(t, 1) - a, v = mesh.corner(t, 2) - a;
        const Vec3d normal = u.cross(v);
        const double twice_area = normal.norm();
        if (!(twice_area > 0.0)) continue;
        const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}));
        const int n = std::clamp(static_cast<int>(std::ceil(std::min(longest / max_edge, 1e9))), 1, most);
        const double area = 0.5 * twice_area / (static_cast<double>(n) * n);
        for (int row = 0; row < n; ++row) {
            for (int k = 0; k < 2 * (n - row) - 1; ++k) {
                // Along a row parts stand in turn upright and on their heads.
                const double third = k % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
                const double x = (k / 2 + third) / n, y = (row + third) / n;
                pieces.push_back({a + x * u + y * v, normal / twice_area, area, t});
            }
        }
    }
    return pieces;
}

} // namespace flotsam
