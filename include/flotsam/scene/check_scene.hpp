#pragma once

#include "flotsam/scene/scene_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace flotsam {

/// What check_scene found in a scene that can be run.
struct SceneCheck {
    struct Body {
        std::string name;
        double volume = 0.0;        ///< [m^3] (2-D: per metre)
        double mass = 0.0;          ///< [kg]; 0 where the scene gives none
        double density_ratio = 0.0; ///< mass / volume / the fluid's density
    };
    std::vector<std::string> notes; ///< what was repaired or will be cut, a sentence each
    std::vector<Body> bodies;
    double fluid_particles = 0.0;  ///< about
    double boundary_samples = 0.0; ///< about
    double memory_bytes = 0.0;     ///< about
};

/// Finds what is wrong with a scene without running it. Loads and checks its meshes. Throws InputError, one sentence:
/// whatever a mesh is refused for, a body outside the tank or in a wall or another body (by more than a quarter of the
/// particle spacing), no fluid left within the walls, more particles than memory holds.
[[nodiscard]] SceneCheck check_scene(const SceneFile& scene);

/// What check_mesh_file found in a mesh file that can be a body or a volume of fluid.
struct MeshFileCheck {
    std::vector<std::string> notes; ///< what was repaired, a sentence each
    std::size_t triangles = 0;
    int parts = 0;
    Aabb bounds;
    double volume = 0.0;                  ///< [m^3]
    Vec3d center_of_mass = Vec3d::Zero(); ///< of the uniform solid [m]
};

/// Finds what is wrong with a mesh file, its numbers taken for metres. Throws InputError as check_mesh does for a
/// solid, and says so where the mesh can be a wall all the same.
[[nodiscard]] MeshFileCheck check_mesh_file(const std::filesystem::path& file);

} // namespace flotsam
