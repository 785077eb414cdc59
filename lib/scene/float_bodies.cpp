#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/hydrostatics.hpp"
#include "scene/prepared_scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

namespace flotsam::scene {
namespace {

Aabb reach_of(const PreparedBody& body)
{
    return bounds(transformed(body.mesh, body.start));
}

/// Where the body floats in water whose surface is at `level`, turned as it is; nothing for one that sinks.
std::optional<Pose> pose_afloat(const PreparedBody& body, double water_density, double level)
{
    const std::optional<double> draft = equilibrium_draft(body.mesh, body.start.orientation, body.mass / water_density);
    if (!draft) return std::nullopt;
    Pose afloat = body.start;
    afloat.position.z() += level - *draft - lowest_point(body.mesh, body.start);
    return afloat;
}

/// Top of the water that the middle of `body` stands over or in: that of the highest block or mesh, of those that reach
/// down to the body and those on top of them. Water that begins above the body is another tank's.
std::optional<double> level_at(const PreparedScene& prepared, const Aabb& body)
{
    std::vector<Aabb> waters;
    for (const SceneBlock& block : prepared.blocks) waters.push_back(block.box);
    for (const TriangleMesh& mesh : prepared.fluid_meshes) waters.push_back(bounds(mesh));
    const Vec3d middle = body.center();
    std::erase_if(
        waters, [&](const Aabb& water) { return !water.contains(Vec3d(middle.x(), middle.y(), water.center().z())); });
    std::sort(waters.begin(), waters.end(), [](const Aabb& a, const Aabb& b) { return a.min.z() < b.min.z(); });
    std::optional<double> level;
    for (const Aabb& water : waters)
        if (water.min.z() <= std::max(body.max.z(), level.value_or(body.max.z())))
            level = std::max(water.max.z(), level.value_or(water.max.z()));
    return level;
}

/// Whether two bodies come closer than half a spacing.
bool touch(const PreparedBody& a, const PreparedBody& b, const SceneFile& scene)
{
    const double gap = 0.5 * scene.particle_spacing;
    const Aabb near_a = reach_of(a).inflated(gap), of_b = reach_of(b);
    if ((near_a.min.array() > of_b.max.array()).any() || (near_a.max.array() < of_b.min.array()).any()) return false;
    const SurfaceQuery query(a.mesh);
    const double edge = std::max(scene.particle_spacing, bounds(b.mesh).size().maxCoeff() / 64.0);
    const std::vector<Vec3d> points = refined(b.mesh, edge).vertices;
    return std::any_of(points.begin(), points.end(), [&](const Vec3d& vertex) {
        Vec3d point = b.start.to_world(vertex);
        if (scene.dimensions == 2) point.y() = 0.0; // away from the ends
        return near_a.contains(point) && query.signed_distance(a.start.to_body(point)) < gap;
    });
}

/// Another body that body k touches; nothing if there is none.
const PreparedBody* neighbour_of(std::size_t k, const SceneFile& scene, const PreparedScene& prepared)
{
    const PreparedBody& body = prepared.bodies[k];
    for (const PreparedBody& other : prepared.bodies)
        if (&other != &body && (touch(body, other, scene) || touch(other, body, scene))) return &other;
    return nullptr;
}

bool is_within_walls(const SceneFile& scene, const PreparedScene& prepared, const PreparedBody& body)
{
    try {
        check_within_walls(scene, prepared, body);
        return true;
    } catch (const InputError&) {
        return false;
    }
}

bool is_joined(std::size_t k, const SceneFile& scene)
{
    return std::any_of(scene.joints.begin(), scene.joints.end(),
                       [&](const SceneJoint& joint) { return joint.a == k || joint.b == k; });
}

/// Moves a body that floats; returns why it was not.
std::string float_body(std::size_t k, const SceneFile& scene, PreparedScene& prepared)
{
    PreparedBody& body = prepared.bodies[k];
    if (is_joined(k, scene)) return "a joint holds it";
    if (scene.bodies[k].lock[2]) return "it is locked along z";
    if (const PreparedBody* other = neighbour_of(k, scene, prepared)) return "it touches " + other->name;
    const std::optional<double> level = level_at(prepared, reach_of(body));
    if (!level) return "no block or mesh of fluid is under its middle";
    const Pose given = body.start;
    const std::optional<Pose> afloat = pose_afloat(body, scene.fluid.density, *level);
    if (!afloat) return {};
    body.start = *afloat;
    std::string obstacle;
    if (const PreparedBody* other = neighbour_of(k, scene, prepared))
        obstacle = other->name;
    else if (!is_within_walls(scene, prepared, body))
        obstacle = "a wall";
    if (obstacle.empty()) return {};
    body.start = given;
    return "where it would float it meets " + obstacle;
}

std::string note_of_move(const PreparedBody& body, double up)
{
    std::ostringstream note;
    note.precision(4);
    note << body.name << " was moved " << (up > 0.0 ? "up" : "down") << " by " << 1000.0 * std::abs(up)
         << " mm to the height at which it floats";
    return note.str();
}

} // namespace

void float_bodies(const SceneFile& scene, PreparedScene& prepared)
{
    if (!is_level(scene.gravity)) return;
    for (std::size_t k = 0; k < prepared.bodies.size(); ++k) {
        const PreparedBody& body = prepared.bodies[k];
        const bool floats = body.mass < scene.fluid.density * body.volume;
        if (scene.bodies[k].motion != SceneBody::Motion::dynamic || !floats) continue;
        const double given = body.start.position.z();
        const std::string obstacle = float_body(k, scene, prepared);
        const double up = body.start.position.z() - given;
        if (!obstacle.empty())
            prepared.notes.push_back(body.name + " stays as given in a scene that starts at rest: " + obstacle);
        else if (std::abs(up) > 1e-6 * scene.particle_spacing)
            prepared.notes.push_back(note_of_move(body, up));
    }
}

} // namespace flotsam::scene
