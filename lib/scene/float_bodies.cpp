#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/equilibrium_poses.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/volume_samples.hpp"
#include "geometry/basin_query.hpp"
#include "geometry/wetted_surface.hpp"
#include "scene/prepared_scene.hpp"
#include "scene/probe_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

namespace flotsam::scene {
namespace {

Aabb reach_of(const PreparedBody& body)
{
    return bounds(transformed(body.mesh, body.start));
}

/// As the search for a stable pose sees it, dry inside. In 2-D a log that is so long that it turns in the plane only.
FloatingBody floating(const PreparedBody& body, TriangleMesh outer, const SceneFile& scene)
{
    FloatingBody result{std::move(outer), body.mass, Vec3d::Zero(), scene.fluid.density, -scene.gravity.z()};
    if (scene.dimensions == 3) return result;
    const Vec3d size = bounds(body.mesh).size();
    const double stretch = 10.0 * std::max(size.x(), size.z()) / size.y();
    for (Vec3d& vertex : result.mesh.vertices) vertex.y() *= stretch;
    result.mass *= stretch;
    return result;
}

/// Water that a scene puts into a body.
struct Cargo {
    std::vector<TriangleMesh*> meshes;
    std::vector<SceneBlock*> blocks;
    double mass = 0.0; ///< [kg]; in 2-D per metre

    void move(double up)
    {
        for (SceneBlock* block : blocks)
            block->box = {block->box.min + up * Vec3d::UnitZ(), block->box.max + up * Vec3d::UnitZ()};
        for (TriangleMesh* mesh : meshes)
            *mesh = transformed(std::move(*mesh), {up * Vec3d::UnitZ(), Quatd::Identity()});
    }
};

/// Of the blocks and meshes of fluid those whose middle is in a hollow of the body, as it stands, and that are no wider
/// than it is.
Cargo cargo_of(const PreparedBody& body, const SceneFile& scene, PreparedScene& prepared)
{
    Cargo cargo;
    const TriangleMesh hull = hull_of(body.mesh, scene.dimensions);
    const auto level = WettedSurface(hull, body.start).level_of_basins(lowest_point(body.mesh, body.start));
    if (!level) return cargo;
    const BasinQuery hollows(hull, body.start, *level);
    const Aabb reach = reach_of(body).inflated(scene.particle_spacing);
    const auto is_aboard = [&](const Aabb& box) {
        const bool is_within =
            reach.min.x() <= box.min.x() && box.max.x() <= reach.max.x() &&
            (scene.dimensions == 2 || (reach.min.y() <= box.min.y() && box.max.y() <= reach.max.y()));
        return is_within && hollows.holds(box.center());
    };
    const auto add = [&](const std::vector<Vec3d>& points) {
        const auto count =
            std::count_if(points.begin(), points.end(), [&](const Vec3d& p) { return hollows.holds(p); });
        cargo.mass +=
            scene.fluid.density * std::pow(scene.particle_spacing, scene.dimensions) * static_cast<double>(count);
    };
    for (SceneBlock& block : prepared.blocks) {
        if (!is_aboard(block.box)) continue;
        cargo.blocks.push_back(&block);
        add(fill_box(block.box, scene.particle_spacing, scene.dimensions));
    }
    for (TriangleMesh& mesh : prepared.fluid_meshes) {
        if (!is_aboard(bounds(mesh))) continue;
        cargo.meshes.push_back(&mesh);
        add(fill_mesh(SurfaceQuery(mesh), scene.particle_spacing, scene.dimensions));
    }
    return cargo;
}

/// As it is turned, at the draft of a vessel with nothing but `cargo` [kg] in her basins; nothing for what is none,
/// sinks or founders.
std::optional<Pose> pose_as_vessel(const PreparedBody& body, const TriangleMesh& outer, const SceneFile& scene,
                                   double level, double cargo)
{
    const TriangleMesh hull = hull_of(outer, scene.dimensions);
    Pose pose = body.start;
    pose.position.z() += level - lowest_point(body.mesh, body.start);
    if (!WettedSurface(hull, pose).level_of_basins(level)) return std::nullopt;
    const auto draft = vessel_draft(hull, pose, level, (body.mass + cargo) / scene.fluid.density);
    if (!draft) return std::nullopt;
    pose.position.z() -= *draft;
    return WettedSurface(hull, pose).has_basin(level) ? std::optional<Pose>(pose) : std::nullopt;
}

/// Where the body may float in water whose surface is at `level`, the best first: the stable pose that it comes to from
/// the one that it is given, unless it may not turn about both horizontal axes, and its height as it is turned; a
/// vessel at her draft as she is turned, with `cargo` [kg] of water in her. Empty for what sinks.
std::vector<Pose> poses_afloat(const PreparedBody& body, const std::array<bool, 6>& lock, const SceneFile& scene,
                               double level, double cargo)
{
    TriangleMesh outer = outer_surface(body.mesh);
    if (const auto vessel = pose_as_vessel(body, outer, scene, level, cargo)) return {*vessel};
    if (cargo > 0.0) return {};
    const FloatingBody afloat = floating(body, std::move(outer), scene);
    const Quatd& given = body.start.orientation;
    const bool turns = scene.dimensions == 2 ? !lock[4] : !lock[3] && !lock[4];
    std::vector<Pose> poses;
    if (!(afloat.mass < afloat.water_density * mass_properties(afloat.mesh).volume)) return {};
    try {
        // What lies as well in any direction (a disc, a ball) is left as it is turned.
        const int all_directions = scene.dimensions == 2 ? 1 : 2;
        const auto stable = turns ? settled_pose(afloat, given) : std::nullopt;
        if (stable && stable->neutral_directions < all_directions) poses.push_back(stable->flotation.pose);
    } catch (const NoEquilibrium&) { // as it is turned, then
    }
    if (const auto held = flotation(afloat, given)) poses.push_back(held->pose);
    for (Pose& pose : poses) pose.position += Vec3d(body.start.position.x(), body.start.position.y(), level);
    return poses;
}

/// Top of the water, other than its cargo, that the middle of `body` stands over or in: that of the highest block or
/// mesh, of those that reach down to the body and those on top of them. Water that begins above the body is another
/// tank's.
std::optional<double> level_at(const PreparedScene& prepared, const Aabb& body, const Cargo& cargo)
{
    const auto is_aboard = [](const auto& cargo_items, const auto& water) {
        return std::find(cargo_items.begin(), cargo_items.end(), &water) != cargo_items.end();
    };
    std::vector<Aabb> waters;
    for (const SceneBlock& block : prepared.blocks)
        if (!is_aboard(cargo.blocks, block)) waters.push_back(block.box);
    for (const TriangleMesh& mesh : prepared.fluid_meshes)
        if (!is_aboard(cargo.meshes, mesh)) waters.push_back(bounds(mesh));
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

/// Tells which bodies touch. What it takes is made for a body when it is first asked for, and once.
class Touching {
  public:
    Touching(const SceneFile& scene, const PreparedScene& prepared)
        : scene_(scene), bodies_(prepared.bodies), queries_(bodies_.size()), points_(bodies_.size())
    {
    }

    /// Another body that body k touches; nothing if there is none.
    const PreparedBody* neighbour_of(std::size_t k)
    {
        for (std::size_t other = 0; other < bodies_.size(); ++other)
            if (other != k && (touch(k, other) || touch(other, k))) return &bodies_[other];
        return nullptr;
    }

  private:
    /// Whether a point of body b comes closer to body a than half a spacing.
    bool touch(std::size_t a, std::size_t b)
    {
        const double gap = 0.5 * scene_.particle_spacing;
        const Aabb near_a = reach_of(bodies_[a]).inflated(gap), of_b = reach_of(bodies_[b]);
        if ((near_a.min.array() > of_b.max.array()).any() || (near_a.max.array() < of_b.min.array()).any())
            return false;
        const SurfaceQuery& surface = query(a);
        const std::vector<Vec3d>& of_surface = points(b);
        return std::any_of(of_surface.begin(), of_surface.end(), [&](const Vec3d& point_body) {
            Vec3d point = bodies_[b].start.to_world(point_body);
            if (scene_.dimensions == 2) point.y() = 0.0; // away from the ends
            return near_a.contains(point) && surface.signed_distance(bodies_[a].start.to_body(point)) < gap;
        });
    }
    const SurfaceQuery& query(std::size_t k)
    {
        if (!queries_[k]) queries_[k].emplace(bodies_[k].mesh);
        return *queries_[k];
    }
    const std::vector<Vec3d>& points(std::size_t k)
    {
        if (points_[k].empty()) points_[k] = surface_points(bodies_[k].mesh, scene_.particle_spacing);
        return points_[k];
    }

    const SceneFile& scene_;
    const std::vector<PreparedBody>& bodies_;
    std::vector<std::optional<SurfaceQuery>> queries_;
    std::vector<std::vector<Vec3d>> points_; ///< body frames
};

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
std::string float_body(std::size_t k, const SceneFile& scene, PreparedScene& prepared, Touching& touching)
{
    PreparedBody& body = prepared.bodies[k];
    if (is_joined(k, scene)) return "a joint holds it";
    if (scene.bodies[k].lock[2]) return "it is locked along z";
    if (const PreparedBody* other = touching.neighbour_of(k)) return "it touches " + other->name;
    Cargo cargo = cargo_of(body, scene, prepared);
    const std::optional<double> level = level_at(prepared, reach_of(body), cargo);
    if (!level) return "no block or mesh of fluid is under its middle";
    const Pose given = body.start;
    std::string obstacle = cargo.mass > 0.0 ? "it would not float upright with the water that is in it"
                                            : "it is not lighter than the water";
    for (const Pose& pose : poses_afloat(body, scene.bodies[k].lock, scene, *level, cargo.mass)) {
        body.start = pose;
        const PreparedBody* other = touching.neighbour_of(k);
        if (other == nullptr && is_within_walls(scene, prepared, body)) {
            cargo.move(pose.position.z() - given.position.z());
            return {};
        }
        obstacle = "where it would float it meets " + (other != nullptr ? other->name : "a wall");
    }
    body.start = given;
    return obstacle;
}

/// Empty where it stands as given.
std::string note_of_move(const PreparedBody& body, const Pose& given, double spacing)
{
    const double up = body.start.position.z() - given.position.z();
    const double turn = given.orientation.angularDistance(body.start.orientation) * 180.0 / std::numbers::pi;
    const bool rises = std::abs(up) > 1e-6 * spacing, turns = turn > 1e-3;
    if (!rises && !turns) return {};
    std::ostringstream note;
    note.precision(4);
    note << body.name << " was ";
    if (rises) note << "moved " << (up > 0.0 ? "up" : "down") << " by " << 1000.0 * std::abs(up) << " mm";
    if (rises && turns) note << " and ";
    if (turns) note << "turned by " << turn << " degrees";
    note << " to where it floats";
    return note.str();
}

} // namespace

void float_bodies(const SceneFile& scene, PreparedScene& prepared)
{
    if (!is_level(scene.gravity)) return;
    Touching touching(scene, prepared);
    for (std::size_t k = 0; k < prepared.bodies.size(); ++k) {
        const PreparedBody& body = prepared.bodies[k];
        if (scene.bodies[k].motion != SceneBody::Motion::dynamic) continue;
        const Pose given = body.start;
        const std::string obstacle = float_body(k, scene, prepared, touching);
        const std::string note = note_of_move(body, given, scene.particle_spacing);
        if (!obstacle.empty())
            prepared.notes.push_back(body.name + " stays as given in a scene that starts at rest: " + obstacle);
        else if (!note.empty())
            prepared.notes.push_back(note);
    }
}

} // namespace flotsam::scene
