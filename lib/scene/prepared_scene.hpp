#pragma once

#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/surface_query.hpp"
#include "flotsam/scene/scene_file.hpp"

#include <string>
#include <vector>

namespace flotsam::scene {

struct PreparedPart {
    Shape shape; ///< mesh files loaded
    Pose pose;   ///< in the body's frame
};

/// A body with its geometry. Its frame sits in the centre of mass and has the principal axes of inertia, as engines
/// want it.
struct PreparedBody {
    std::string name;  ///< for sentences: bodies[0] ("crate")
    TriangleMesh mesh; ///< closed, in the body's frame
    std::vector<PreparedPart> parts;
    double volume = 0.0;           ///< [m^3]
    double mass = 0.0;             ///< [kg]; 0: not given
    Vec3d inertia = Vec3d::Zero(); ///< principal [kg m^2]; zero where mass is
    Pose frame;                    ///< of the body, in the frame of the scene's shape
    Pose start;                    ///< of the body, in the world
};

struct PreparedWall {
    TriangleMesh mesh; ///< in the world
    bool closed = false;
    std::string name; ///< for sentences: walls[0] ("basin")
};

struct PreparedScene {
    std::vector<SceneBlock> blocks; ///< cut by the box wall
    std::vector<TriangleMesh> fluid_meshes;
    std::vector<PreparedWall> walls;
    std::vector<PreparedBody> bodies;
    std::vector<std::string> notes;
    double fluid_particles = 0.0;
    double boundary_samples = 0.0;
    double memory_bytes = 0.0;
};

/// Loads and checks the meshes of a scene, and works out masses. Throws InputError; also for more particles than memory
/// holds, before it makes anything of that size.
[[nodiscard]] PreparedScene prepare_scene(const SceneFile& scene);

/// A body of the scene, its meshes loaded and checked; throws InputError.
[[nodiscard]] PreparedBody prepare_body(const SceneFile& scene, std::size_t number, PreparedScene& prepared);

/// Puts bodies of a scene that starts at rest into the stable pose in which they float, and notes it; says of those
/// that float and are not moved why.
void float_bodies(const SceneFile& scene, PreparedScene& prepared);

/// Refuses a body that is outside the tank or overlaps a wall, by an InputError.
void check_within_walls(const SceneFile& scene, const PreparedScene& prepared, const PreparedBody& body);

/// Refuses bodies that are outside the tank or overlap a wall or each other, by an InputError.
void check_bodies(const SceneFile& scene, const PreparedScene& prepared);

/// Refuses what is so far from the origin that single precision does not resolve the spacing, by an InputError.
void check_reach(const SceneFile& scene, const PreparedScene& prepared);

/// Notes fluid that bodies cut away; refuses a scene of which no fluid is left, by an InputError.
void check_fluid(const SceneFile& scene, PreparedScene& prepared);

/// Notes probes that are outside of all walls and fluid.
void check_probes(const SceneFile& scene, PreparedScene& prepared);

/// All of the above.
[[nodiscard]] PreparedScene prepare_and_check(const SceneFile& scene);

} // namespace flotsam::scene
