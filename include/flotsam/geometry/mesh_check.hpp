#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <string>
#include <vector>

namespace flotsam {

/// What a mesh is needed for, and what it is called in sentences.
struct MeshCheckOptions {
    std::string name = "mesh";     ///< usually the file's name
    bool must_be_closed = true;    ///< bodies and fluid volumes; walls may be open sheets
    double particle_spacing = 0.0; ///< [m]; > 0 also compares the size of the solid with it
};

/// What check_mesh found and did.
struct MeshCheckReport {
    std::vector<std::string> notes; ///< one sentence per repair or warning, naming the mesh
    int parts = 0;                  ///< connected parts
    int welded_vertices = 0;        ///< merged into another at the same place
    int dropped_triangles = 0;      ///< degenerate or doubled
    int flipped_triangles = 0;      ///< turned to face outward
    bool closed = false;
};

/// Checks a mesh for use as a solid (or, with must_be_closed = false, as a wall) and repairs in place what is safe:
/// welds coincident vertices, drops degenerate and doubled triangles, turns triangles so that each part is consistently
/// oriented and closed parts face outward (a part nested inside an odd number of others is a cavity and faces inward).
/// On return `part_of_triangle` numbers the connected parts.
///
/// Parts of a file may touch, and a part may be spread over several of the file's (materials); a connected part is
/// named as its first triangle's part in the file. An open part keeps the side that most of its triangles had.
///
/// Throws InputError, one sentence that names the mesh, the place (vertex or edge, with coordinates) and what is
/// allowed: empty, not finite, not orientable; and where it must be closed: open (with the number of open edges and
/// where), an edge shared by more than two triangles, parts that cut each other, zero volume, smaller than the particle
/// spacing resolves (extent below 2 spacings in every direction). Walls may branch and cross: there, such edges part
/// the sheets that meet in them. Throws std::invalid_argument for a negative spacing.
MeshCheckReport check_mesh(TriangleMesh& mesh, const MeshCheckOptions& options = {});

} // namespace flotsam
