#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

namespace flotsam {

struct Weld {
    int merged = 0;        ///< vertices
    int merged_apart = 0;  ///< of them, those that were not at exactly the same place
    double farthest = 0.0; ///< distance that one of them moved [m]
};

/// Merges each vertex into the first one within `tolerance` [m] of it; triangles keep their number.
Weld weld_vertices(TriangleMesh& mesh, double tolerance);

/// Drops triangles with fewer than three different vertices, and all but the first of those with the same three in the
/// same part. A sliver with three different vertices stays: its neighbours would come apart. Gives how many went.
int drop_degenerate_triangles(TriangleMesh& mesh);

/// Drops the vertices that no triangle uses; the others keep their order.
void drop_unused_vertices(TriangleMesh& mesh);

} // namespace flotsam
