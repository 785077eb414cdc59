#pragma once

#include "flotsam/geometry/load_mesh.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace flotsam {

/// A mesh file that a scene names: `{"file", "scale": 1, "up": "z" | "y" | "x"}`.
struct SceneMesh {
    std::filesystem::path file; ///< relative names count from the scene file; already resolved here
    MeshFileOptions options;
};

/// `{"min", "max", "velocity"}`: a box of water [m], [m/s].
struct SceneBlock {
    Aabb box;
    Vec3d velocity = Vec3d::Zero();
};

/// `{"file", "scale", "up", "position", "rotation_deg", "velocity"}`: water inside a closed mesh.
struct SceneFluidMesh {
    SceneMesh mesh;
    Pose pose;
    Vec3d velocity = Vec3d::Zero();
};

struct SceneFluid {
    std::string name = "water";
    double density = 1000.0;           ///< [kg/m^3]
    double kinematic_viscosity = 1e-6; ///< [m^2/s]
    std::vector<SceneBlock> blocks;
    std::vector<SceneFluidMesh> meshes;
};

/// `{"name", "box": {"min", "max", "open"}}` or `{"name", "mesh": {"file", "scale", "up", "position", "rotation_deg",
/// "side": "auto" | "inside" | "outside" | "both"}}`.
struct SceneWall {
    std::string name;
    Aabb box;                      ///< in 2-D half a metre to each side of the plane, open there
    std::vector<std::string> open; ///< sides of the box
    std::optional<SceneMesh> mesh; ///< instead of the box
    Pose pose;                     ///< of the mesh
    WallSide side = WallSide::automatic;
};

/// A simple shape, or one of a compound's, in the frame of the body's shape.
struct SceneShapePart {
    std::variant<BoxShape, SphereShape, CylinderShape, DiscShape, SceneMesh> shape;
    Pose pose;
};

/// `{"name", "shape", "density" or "mass", "position", "rotation_deg", "velocity", "angular_velocity", "friction",
/// "lock", "motion", "center_of_mass", "inertia"}`.
struct SceneBody {
    std::string name;
    std::vector<SceneShapePart> parts;      ///< one, or those of `{"compound": [{SHAPE, "position", "rotation_deg"}]}`
    std::optional<double> density;          ///< [kg/m^3]
    std::optional<double> mass;             ///< [kg] (in 2-D per metre of width)
    Pose pose;                              ///< of the shape's origin: a primitive's centre, a mesh file's origin
    Vec3d velocity = Vec3d::Zero();         ///< of the centre of mass [m/s]
    Vec3d angular_velocity = Vec3d::Zero(); ///< [rad/s]
    double friction = 0.5;                  ///< against walls; between two bodies the product of both
    std::array<bool, 6> lock{};             ///< x, y, z, rx, ry, rz in the world frame
    enum class Motion { dynamic, fixed, moving } motion = Motion::dynamic;
    std::optional<Vec3d> center_of_mass; ///< in the shape's frame [m]; else that of the uniform solid
    std::optional<Vec3d> inertia;        ///< about the centre of mass, shape's axes [kg m^2]; else of the uniform solid
};

/// `{"name", "type": "hinge" | "slider" | "ball", "a", "b", "point", "axis", "limits_deg" or "limits", "motor":
/// {"velocity", "max_torque" or "max_force"}}`. Joins body `a` to body `b`, or to the world. Point and axis are in the
/// world frame of the pose in which the scene starts, where the joint stands at 0. Positive is, seen from `b`: a hinge
/// turning `a` about the axis by the right-hand rule, a slider moving `a` along it.
struct SceneJoint {
    struct Limits {
        double low = 0.0, high = 0.0; ///< <= 0 and >= 0 [rad] or [m]
    };
    struct Motor {
        double velocity = 0.0; ///< that it holds as far as its strength goes [rad/s] or [m/s]
        double strength = 0.0; ///< max_torque [N m] or max_force [N]
    };
    std::string name; ///< "joint0" and so on where the file gives none
    enum class Type { hinge, slider, ball } type = Type::hinge;
    std::size_t a = 0;            ///< number of the body
    std::optional<std::size_t> b; ///< of the other one; nothing: the world
    Vec3d point = Vec3d::Zero();
    Vec3d axis = Vec3d::Zero();   ///< of length 1; in 2-D y for hinge and ball, in 3-D zero for a ball
    std::optional<Limits> limits; ///< of hinge or slider
    std::optional<Motor> motor;   ///< of hinge or slider
};

/// `{"joints": [NAME, ...]}`: joints that Bullet solves in reduced coordinates, as one btMultiBody; they cannot come
/// open. Their bodies are dynamic and hang in a tree, each `a` by one joint, from the world or from a body that is the
/// `a` of none; no other joint holds one of them.
struct SceneArticulation {
    std::vector<std::size_t> joints; ///< numbers, each after the one that holds its `b`
};

/// `{"name", "pressure": [x, y, z]}` in Pa or `{"name", "level": [x, y]}` in m.
struct SceneProbe {
    std::string name;
    enum class Kind { pressure, level } kind = Kind::pressure;
    Vec3d point = Vec3d::Zero();
};

struct SceneCamera {
    Vec3d position = Vec3d::Zero();
    Vec3d look_at = Vec3d::Zero();
    double fov_deg = 40.0; ///< vertical
};

/// `true`, `false` or `{"width", "height", "every", "camera": {"position", "look_at", "fov_deg"}}`.
struct ScenePictures {
    int width = 1280;
    int height = 720;
    int every = 0; ///< frames from one to the next; 0: the first, the last and about eight between
    std::optional<SceneCamera> camera;
};

struct SceneOutput {
    double frames_per_second = 30.0;
    bool vtk = false;
    std::optional<ScenePictures> pictures;
};

/// A scene, as its file says it: SI units, Z up. Every field stands for one key of the file; what a file leaves out has
/// the default written here. Required: `flotsam` (the version, 1), `particle_spacing`, `duration`, `fluids`; a name and
/// a shape for each body, and for a dynamic one `density` or `mass`; `type`, `a`, `point` and (hinge, slider) `axis`
/// for each joint.
///
/// In 2-D (the plane y = 0) points and vectors are [x, z], or [x, y, z] with y = 0; shapes are box [x, z] and disc.
/// `rotation_deg` is a rotation vector: axis times angle.
struct SceneFile {
    std::filesystem::path file;
    int dimensions = 3;
    double particle_spacing = 0.0;          ///< [m]
    Vec3d gravity = Vec3d(0.0, 0.0, -9.81); ///< [m/s^2]
    double duration = 0.0;                  ///< [s]
    double max_time_step = 0.004;           ///< time_step.max [s]
    double cfl = 0.4;                       ///< time_step.cfl
    KernelKind kernel = KernelKind::quintic;
    PressureSettings pressure;
    /// at_rest: fluid settled around the bodies, and those that float put into their stable pose first
    FluidWorldSettings::Start start = FluidWorldSettings::Start::as_given;
    SceneFluid fluid;
    std::vector<SceneWall> walls;
    std::vector<SceneBody> bodies;
    std::vector<SceneJoint> joints;
    std::vector<SceneArticulation> articulations;
    std::vector<SceneProbe> probes;
    SceneOutput output;
};

/// Reads a scene file. `overrides` are "path=value": a dotted path with indices or names ("bodies.0.density",
/// "bodies.crate.density"), a value in JSON or else text; they count before anything is checked. Throws InputError, one
/// sentence that names the file, the path in it and what is allowed.
[[nodiscard]] SceneFile read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same for a text; `file` is what it is called, and where relative file names count from.
[[nodiscard]] SceneFile parse_scene(std::string_view text, const std::filesystem::path& file,
                                    const std::vector<std::string>& overrides = {});

} // namespace flotsam
