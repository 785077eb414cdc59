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

/// Area inside closed lines, holes taken off.
[[nodiscard]] double enclosed_area(const std::vector<CutLine>& lines);

} // namespace flotsam
