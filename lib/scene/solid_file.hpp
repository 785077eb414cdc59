#pragma once

#include "flotsam/geometry/load_mesh.hpp"
#include "flotsam/geometry/mesh_check.hpp"

#include <filesystem>

namespace flotsam::scene {

/// A closed mesh of a file, repaired, and what was found in it.
struct SolidFile {
    TriangleMesh mesh;
    MeshCheckReport report;
};

/// Throws InputError as load_mesh and check_mesh do, and says so where the mesh can be a wall all the same.
[[nodiscard]] SolidFile read_solid(const std::filesystem::path& file, const MeshFileOptions& options = {});

} // namespace flotsam::scene
