#include "scene/recorder.hpp"

#include "scene/history_columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace flotsam::scene {
namespace {

void append(std::vector<double>& row, const Vec3d& v)
{
    row.insert(row.end(), v.data(), v.data() + 3);
}

std::string numbered(const char* stem, std::size_t frame, const char* ending)
{
    char number[32];
    std::snprintf(number, sizeof number, "%04zu", frame);
    return std::string(stem) + number + ending;
}

std::vector<Pose> poses_of(const SceneWorld& world)
{
    std::vector<Pose> poses;
    for (std::size_t k = 0; k < world.body_count(); ++k) poses.push_back(world.body(k).pose);
    return poses;
}

/// In 2-D bodies and walls are a metre long in y, which would hide the plane: made as thin as a particle.
TriangleMesh for_picture(TriangleMesh mesh, const SceneFile& scene)
{
    if (scene.dimensions == 2)
        for (Vec3d& vertex : mesh.vertices) vertex.y() *= scene.particle_spacing;
    return mesh;
}

/// Speed that is drawn white: of water that fell through the depth of the fluid. One for all pictures of a run.
double white_speed(const SceneFile& scene, const FluidState& fluid)
{
    double low = 1e300, high = -1e300;
    for (const Vec4& position : fluid.position) {
        low = std::min(low, static_cast<double>(position.z()));
        high = std::max(high, static_cast<double>(position.z()));
    }
    return std::sqrt(2.0 * scene.gravity.norm() * std::max(0.0, high - low));
}

Camera camera_of(const ScenePictures& pictures, const PictureScene& picture, int dimensions)
{
    const double aspect = static_cast<double>(pictures.width) / pictures.height;
    if (!pictures.camera) return default_camera(bounds(picture), aspect, dimensions);
    Camera camera;
    camera.position = pictures.camera->position;
    camera.look_at = pictures.camera->look_at;
    camera.field_of_view_deg = pictures.camera->fov_deg;
    const Vec3d view = (camera.look_at - camera.position).normalized();
    if (std::abs(view.z()) > 0.999) camera.up = Vec3d::UnitY();
    return camera;
}

} // namespace

std::vector<std::string> history_columns(const SceneFile& scene)
{
    std::vector<std::string> columns{"t"};
    for (const SceneBody& body : scene.bodies)
        for (const char* suffix :
             {"x", "y", "z", "rx", "ry", "rz", "vx", "vy", "vz", "wx", "wy", "wz", "fx", "fy", "fz", "tx", "ty", "tz"})
            columns.push_back(body.name + "." + suffix);
    for (const SceneJoint& joint : scene.joints) columns.push_back(joint.name + ".position");
    for (const SceneProbe& probe : scene.probes) columns.push_back(probe.name);
    return columns;
}

// -- history ------------------------------------------------------------------------------------------------------

History::History(const std::filesystem::path& file, const SceneFile& scene)
    : writer_(file, history_columns(scene)), impulses_(scene.bodies.size())
{
}

void History::add_step(const SceneWorld& world, double dt)
{
    for (std::size_t k = 0; k < impulses_.size(); ++k)
        impulses_[k] += world.fluid().fluid_wrench(static_cast<int>(k)) * dt;
    seconds_ += dt;
}

void History::write_row(const SceneFile& scene, const PreparedScene& prepared, const SceneWorld& world)
{
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    std::vector<double> row{world.fluid().time()};
    for (std::size_t k = 0; k < impulses_.size(); ++k) {
        const BodyNow now = world.body(k);
        const Wrench force = seconds_ > 0.0 ? impulses_[k] * (1.0 / seconds_) : Wrench();
        append(row, now.pose.position);
        append(row,
               kDegrees * rotation_vector(now.pose.orientation * prepared.bodies[k].frame.orientation.conjugate()));
        append(row, now.twist.linear);
        append(row, now.twist.angular);
        append(row, force.linear);
        append(row, force.angular);
    }
    for (std::size_t k = 0; k < scene.joints.size(); ++k) {
        const bool slides = scene.joints[k].type == SceneJoint::Type::slider;
        row.push_back(world.joint(k).position * (slides ? 1.0 : kDegrees));
    }
    for (const SceneProbe& probe : scene.probes)
        row.push_back(read_probe(world.fluid(), probe).value_or(std::numeric_limits<double>::quiet_NaN()));
    writer_.row(row);
    std::fill(impulses_.begin(), impulses_.end(), Wrench());
    seconds_ = 0.0;
}

// -- ParaView -----------------------------------------------------------------------------------------------------

VtkFrames::VtkFrames(const std::filesystem::path& directory, const PreparedScene& prepared, const SceneWorld& world)
    : directory_(directory), prepared_(prepared), particles_(directory / "particles.pvd"),
      bodies_(directory / "bodies.pvd")
{
    std::filesystem::create_directories(directory_ / "vtk");
    std::vector<PlacedMesh> walls;
    for (int k = 0; k < world.fluid().wall_count(); ++k) walls.push_back({&world.fluid().wall_mesh(k), Pose()});
    if (!walls.empty()) write_bodies_vtp(directory_ / "vtk" / "walls.vtp", walls);
}

void VtkFrames::add(const SceneWorld& world)
{
    writer_.add([this, time = world.fluid().time(), fluid = world.fluid().fluid(), poses = poses_of(world)] {
        write(time, fluid, poses);
    });
}

void VtkFrames::write(double time, const FluidState& fluid, const std::vector<Pose>& poses)
{
    const std::filesystem::path particles = "vtk/" + numbered("particles_", particles_.size(), ".vtp");
    write_particles_vtp(directory_ / particles, fluid);
    particles_.add(time, particles);
    if (poses.empty()) return;
    std::vector<PlacedMesh> placed;
    for (std::size_t k = 0; k < poses.size(); ++k) placed.push_back({&prepared_.bodies[k].mesh, poses[k]});
    const std::filesystem::path bodies = "vtk/" + numbered("bodies_", bodies_.size(), ".vtp");
    write_bodies_vtp(directory_ / bodies, placed);
    bodies_.add(time, bodies);
}

// -- pictures -----------------------------------------------------------------------------------------------------

Pictures::Pictures(const std::filesystem::path& directory, const SceneFile& scene, const PreparedScene& prepared,
                   const SceneWorld& world, int threads)
    : directory_(directory / "pictures"), width_(scene.output.pictures->width), height_(scene.output.pictures->height),
      workers_(threads)
{
    std::filesystem::create_directories(directory_);
    for (int k = 0; k < world.fluid().wall_count(); ++k)
        walls_.push_back(for_picture(world.fluid().wall_mesh(k), scene));
    for (const PreparedBody& body : prepared.bodies) bodies_.push_back(for_picture(body.mesh, scene));
    for (const TriangleMesh& mesh : walls_) picture_.walls.push_back({.placed = {&mesh, Pose()}});
    for (std::size_t k = 0; k < bodies_.size(); ++k)
        picture_.bodies.push_back({{&bodies_[k], world.body(k).pose}, body_color(k)});
    picture_.radius = 0.55 * scene.particle_spacing;
    picture_.particles = world.fluid().fluid().position;
    picture_.max_speed = white_speed(scene, world.fluid().fluid());
    picture_.camera = camera_of(*scene.output.pictures, picture_, scene.dimensions);
    if (scene.dimensions == 3) picture_.ground = bounds(picture_).min.z();
    const double frames = scene.duration * scene.output.frames_per_second;
    every_ = scene.output.pictures->every > 0 ? scene.output.pictures->every
                                              : std::max(1, static_cast<int>(std::ceil(frames / 9.0)));
}

void Pictures::add(int frame, bool last, const SceneWorld& world)
{
    if (frame % every_ != 0 && !last) return;
    const FluidState& fluid = world.fluid().fluid();
    writer_.add([this, frame, positions = fluid.position, velocities = fluid.velocity, poses = poses_of(world)] {
        write(frame, positions, velocities, poses);
    });
}

void Pictures::write(int frame, const std::vector<Vec4>& positions, const std::vector<Vec4>& velocities,
                     const std::vector<Pose>& poses)
{
    picture_.particles = positions;
    picture_.velocities = velocities;
    for (std::size_t k = 0; k < poses.size(); ++k) picture_.bodies[k].placed.pose = poses[k];
    write_png(directory_ / numbered("frame_", static_cast<std::size_t>(frame), ".png"),
              renderer_.render(picture_, width_, height_, workers_));
}

} // namespace flotsam::scene
