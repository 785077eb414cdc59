#include "scene/prepared_scene.hpp"
#include "scene/probe_points.hpp"
#include "scene/refuse.hpp"
#include "scene/tanks.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flotsam::scene {
namespace {

/// Bodies may touch walls and each other, and meshes are not exact: this much of a spacing is not an overlap.
constexpr double kTouching = 0.25;

/// A body where it starts, with the points of its surface and what is inside of it.
struct PlacedBody {
    std::string name;
    Pose pose;
    SurfaceQuery query;         ///< in the body's frame
    std::vector<Vec3d> surface; ///< world points about a spacing apart
    std::vector<Vec3d> points;  ///< these, and world points well below the surface
    Aabb reach;                 ///< of the surface, in the world

    /// In 2-D, where bodies are a metre long in y, all points are moved into the plane, far from the ends.
    PlacedBody(const PreparedBody& body, const SceneFile& scene) : name(body.name), pose(body.start), query(body.mesh)
    {
        for (const Vec3d& point : surface_points(body.mesh, scene.particle_spacing)) {
            reach.extend(pose.to_world(point));
            surface.push_back(placed(point, scene));
        }
        points = surface;
        for (const Vec3d& point : inner_points(query, kTouching * scene.particle_spacing))
            points.push_back(placed(point, scene));
    }
    [[nodiscard]] Vec3d placed(const Vec3d& point_body, const SceneFile& scene) const
    {
        Vec3d point = pose.to_world(point_body);
        if (scene.dimensions == 2) point.y() = 0.0;
        return point;
    }
    [[nodiscard]] double deepest_of(const PlacedBody& other) const
    {
        double deepest = -1.0;
        for (const Vec3d& point : other.points) deepest = std::max(deepest, depth(point));
        return deepest;
    }
    [[nodiscard]] double depth(const Vec3d& point) const // inside the body, else negative
    {
        return reach.contains(point) ? -query.signed_distance(pose.to_body(point)) : -1.0;
    }
};

std::string millimetres(double metres)
{
    std::ostringstream text;
    text.precision(3);
    text << 1000.0 * metres << " mm";
    return text.str();
}

// -- walls --------------------------------------------------------------------------------------------------------

/// How far the body reaches through a closed side of a box, and whether it is beyond it altogether.
struct Passage {
    double depth = -1e300;
    bool wholly = false;
    const char* side = "";
};

Passage passage_through(const SceneWall& wall, const Aabb& reach)
{
    const std::array low{"-x", "-y", "-z"}, high{"+x", "+y", "+z"};
    Passage worst;
    const auto consider = [&](const char* side, double depth, bool wholly) {
        const bool open = std::find(wall.open.begin(), wall.open.end(), side) != wall.open.end();
        if (!open && depth > worst.depth) worst = {depth, wholly, side};
    };
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        consider(low[k], wall.box.min[axis] - reach.min[axis], reach.max[axis] <= wall.box.min[axis]);
        consider(high[k], reach.max[axis] - wall.box.max[axis], reach.min[axis] >= wall.box.max[axis]);
    }
    return worst;
}

/// A triangle's points about `spacing` apart, those within `reach`.
template <class Visit>
void visit_points(const TriangleMesh& mesh, std::size_t triangle, const Aabb& reach, double spacing, Visit&& visit)
{
    const Vec3d a = mesh.corner(triangle, 0);
    const Vec3d ab = mesh.corner(triangle, 1) - a, ac = mesh.corner(triangle, 2) - a;
    Aabb box;
    for (const Vec3d& corner : {a, Vec3d(a + ab), Vec3d(a + ac)}) box.extend(corner);
    if (!((box.min.array() <= reach.max.array()).all() && (box.max.array() >= reach.min.array()).all())) return;
    const int n = static_cast<int>(std::min(2000.0, std::ceil(std::max(ab.norm(), ac.norm()) / spacing)));
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k + i <= n; ++k) {
            const Vec3d point = a + ab * (static_cast<double>(i) / n) + ac * (static_cast<double>(k) / n);
            if (reach.contains(point)) visit(point);
        }
}

/// How deep the surface of a mesh wall comes into the body.
double wall_in_body(const TriangleMesh& wall, const PlacedBody& body, double spacing)
{
    double deepest = -1.0;
    for (std::size_t t = 0; t < wall.triangles.size(); ++t)
        visit_points(wall, t, body.reach, spacing,
                     [&](const Vec3d& point) { deepest = std::max(deepest, body.depth(point)); });
    return deepest;
}

/// Whether the water is inside a closed wall: asked of points of the fluid.
bool holds_the_fluid(const SceneFile& scene, const PreparedScene& prepared, const SurfaceQuery& wall)
{
    std::vector<Vec3d> points;
    for (const SceneBlock& block : prepared.blocks) {
        const std::vector<Vec3d> of_block = grid_in(block.box);
        points.insert(points.end(), of_block.begin(), of_block.end());
    }
    for (const TriangleMesh& mesh : prepared.fluid_meshes) { // its vertices may lie on the wall
        const std::vector<Vec3d> filled = inner_points(SurfaceQuery(mesh), 0.0);
        points.insert(points.end(), filled.begin(), filled.end());
    }
    if (scene.dimensions == 2)
        for (Vec3d& point : points) point.y() = 0.0;
    const auto inside = std::count_if(points.begin(), points.end(), [&](const Vec3d& p) { return wall.inside(p); });
    return 2 * static_cast<std::size_t>(inside) > points.size();
}

struct Tank {
    const PreparedWall* wall = nullptr;
    const SceneWall* settings = nullptr;
    std::optional<SurfaceQuery> closed; ///< of a closed mesh
    bool holds_water = true;            ///< a container, else an obstacle or a sheet
};

std::vector<Tank> tanks_of(const SceneFile& scene, const PreparedScene& prepared)
{
    std::vector<Tank> tanks(prepared.walls.size());
    for (std::size_t k = 0; k < tanks.size(); ++k) {
        Tank& tank = tanks[k];
        tank.wall = &prepared.walls[k];
        tank.settings = &scene.walls[k];
        if (!tank.settings->mesh) continue;
        if (tank.wall->closed) tank.closed.emplace(tank.wall->mesh);
        tank.holds_water =
            tank.closed &&
            (tank.settings->side == WallSide::inside ||
             (tank.settings->side == WallSide::automatic && holds_the_fluid(scene, prepared, *tank.closed)));
    }
    return tanks;
}

/// How far the body's surface comes out of a container (> 0), or stays within it.
Passage passage_out_of(const Tank& tank, const PlacedBody& body)
{
    if (!tank.closed) return passage_through(*tank.settings, body.reach);
    Passage out{-1e300, true, "surface"};
    for (const Vec3d& point : body.surface) {
        const double distance = tank.closed->signed_distance(point);
        out.depth = std::max(out.depth, distance);
        out.wholly = out.wholly && distance > 0.0;
    }
    return out;
}

/// The box walls that bound the tank that the body is in, or that it reaches out of the least.
std::vector<std::size_t> boxes_around(const SceneFile& scene, const PlacedBody& body)
{
    std::vector<std::size_t> nearest;
    double least = 1e300;
    for (std::vector<std::size_t>& tank : tanks_of_boxes(scene)) {
        double out = -1e300;
        for (const std::size_t wall : tank) out = std::max(out, passage_through(scene.walls[wall], body.reach).depth);
        if (out >= least) continue;
        least = out;
        nearest = std::move(tank);
    }
    return nearest;
}

/// All that is outside a container is solid to the fluid, so a body must be inside of every one.
void check_container(const SceneFile& scene, const Tank& tank, const PlacedBody& body, double tolerance)
{
    const Passage out = passage_out_of(tank, body);
    if (out.depth <= tolerance) return;
    const std::string side = std::string(out.side) + (tank.closed ? "" : " side");
    if (out.wholly) refuse(scene, body.name, " is outside the tank, beyond the " + side + " of " + tank.wall->name);
    refuse(scene, body.name,
           " overlaps " + tank.wall->name + ": it reaches " + millimetres(out.depth) + " through its " + side);
}

void check_obstacle(const SceneFile& scene, const Tank& tank, const PlacedBody& body, double tolerance)
{
    double depth = tank.settings->mesh ? wall_in_body(tank.wall->mesh, body, scene.particle_spacing) : -1.0;
    if (tank.closed && !tank.holds_water && tank.settings->side != WallSide::both)
        for (const Vec3d& point : body.points)
            if (tank.closed->bounds().contains(point)) depth = std::max(depth, -tank.closed->signed_distance(point));
    if (depth > tolerance) refuse(scene, body.name, " overlaps " + tank.wall->name + " by " + millimetres(depth));
}

/// Open meshes have no inside, but nothing belongs beside or below all walls.
void check_bounds_of_walls(const SceneFile& scene, const PreparedScene& prepared, const PlacedBody& body)
{
    Aabb walls;
    for (const PreparedWall& wall : prepared.walls)
        for (const Vec3d& vertex : wall.mesh.vertices) walls.extend(vertex);
    if (walls.empty()) return;
    const bool beside = (body.reach.min.head<2>().array() >= walls.max.head<2>().array()).any() ||
                        (body.reach.max.head<2>().array() <= walls.min.head<2>().array()).any();
    if (beside || body.reach.max.z() <= walls.min.z())
        refuse(scene, body.name, " is outside the tank, beside or below all walls");
}

void check_walls(const SceneFile& scene, const PreparedScene& prepared, const std::vector<Tank>& tanks,
                 const PlacedBody& body, double tolerance)
{
    const std::vector<std::size_t> around = boxes_around(scene, body);
    for (std::size_t k = 0; k < tanks.size(); ++k)
        if (!tanks[k].holds_water)
            check_obstacle(scene, tanks[k], body, tolerance);
        else if (scene.walls[k].mesh || std::find(around.begin(), around.end(), k) != around.end())
            check_container(scene, tanks[k], body, tolerance);
    check_bounds_of_walls(scene, prepared, body);
}

// -- other bodies -------------------------------------------------------------------------------------------------

void check_pair(const SceneFile& scene, const PlacedBody& a, const PlacedBody& b, double tolerance)
{
    const double depth = std::max(a.deepest_of(b), b.deepest_of(a));
    if (depth > tolerance) refuse(scene, a.name, " overlaps " + b.name + " by " + millimetres(depth));
}

} // namespace

void check_within_walls(const SceneFile& scene, const PreparedScene& prepared, const PreparedBody& body)
{
    check_walls(scene, prepared, tanks_of(scene, prepared), PlacedBody(body, scene),
                kTouching * scene.particle_spacing);
}

void check_bodies(const SceneFile& scene, const PreparedScene& prepared)
{
    const double tolerance = kTouching * scene.particle_spacing;
    std::vector<PlacedBody> bodies;
    for (const PreparedBody& body : prepared.bodies) bodies.emplace_back(body, scene);
    const std::vector<Tank> tanks = tanks_of(scene, prepared);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        check_walls(scene, prepared, tanks, bodies[k], tolerance);
        for (std::size_t other = 0; other < k; ++other) check_pair(scene, bodies[other], bodies[k], tolerance);
    }
}

} // namespace flotsam::scene
