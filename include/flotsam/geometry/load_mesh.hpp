#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <filesystem>

namespace flotsam {

/// How the numbers in a mesh file are to be read.
struct MeshFileOptions {
    double scale = 1.0;                           ///< metres per unit of the file, > 0
    enum class UpAxis { z, y, x } up = UpAxis::z; ///< axis of the file that becomes +z; z: as it is
};

/// Whether the file is called like a mesh file that load_mesh reads.
[[nodiscard]] bool is_mesh_file_name(const std::filesystem::path& file);

/// Reads OBJ, STL, PLY, DAE, glTF or GLB through assimp; the node transforms of the file are applied, nothing else
/// is: no unit or axis conversion beyond `options`. Polygons become triangles, points and lines are dropped, several
/// parts stay several parts. Vertices are not welded and nothing is checked beyond what reading needs: see check_mesh.
/// Coordinates have float's digits, as assimp keeps them.
/// Throws InputError naming the file: missing, not readable, of an unknown format, truncated, with numbers or indices
/// that are not what the format says, without triangles, or so far from its origin that float's digits are too few.
[[nodiscard]] TriangleMesh load_mesh(const std::filesystem::path& file, const MeshFileOptions& options = {});

} // namespace flotsam
