#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <vector>

namespace flotsam {

using Vec2d = Eigen::Vector2d; ///< x and z of a point in the plane y = 0

/// A connected line of a mesh's cut with the plane y = 0. Its triangles' normals point to the right of the way along.
struct CutLine {
    std::vector<Vec2d> points; ///< a closed line does not repeat its first
    bool closed = false;
};

/// All lines of the cut. Vertices in the plane count as lying on its positive side.
[[nodiscard]] std::vector<CutLine> cut_at_y0(const TriangleMesh& mesh);

[[nodiscard]] inline Vec3d in_space(const Vec2d& p)
{
    return {p.x(), 0.0, p.y()};
}

/// The lines pulled along y by `half` both ways: distances in the plane are those from the lines.
[[nodiscard]] TriangleMesh ribbon(const std::vector<CutLine>& lines, double half);

/// Area inside closed lines, holes taken off.
[[nodiscard]] double enclosed_area(const std::vector<CutLine>& lines);

} // namespace flotsam
