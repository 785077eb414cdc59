#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

namespace flotsam {

/// A borrowed mesh and where it is now.
struct PlacedMesh {
    const TriangleMesh* mesh = nullptr; ///< in its body's frame [m]; never null
    Pose pose;                          ///< body to world
};

} // namespace flotsam
