#include "flotsam/scene/check_scene.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/volume_samples.hpp"
#include "scene/prepared_scene.hpp"

namespace flotsam {
namespace scene {
namespace {

/// More points than this are not laid out only to count what bodies cut away.
constexpr double kMostPointsToCount = 2e6;

std::vector<Vec3d> fluid_points(const SceneFile& scene, const PreparedScene& prepared)
{
    std::vector<Vec3d> points;
    for (const SceneBlock& block : prepared.blocks) {
        const std::vector<Vec3d> filled = fill_box(block.box, scene.particle_spacing, scene.dimensions);
        points.insert(points.end(), filled.begin(), filled.end());
    }
    for (const TriangleMesh& mesh : prepared.fluid_meshes) {
        const std::vector<Vec3d> filled = fill_mesh(SurfaceQuery(mesh), scene.particle_spacing, scene.dimensions);
        points.insert(points.end(), filled.begin(), filled.end());
    }
    return points;
}

/// Takes away the points inside the body; returns how many.
std::size_t cut_by(const PreparedBody& body, std::vector<Vec3d>& points)
{
    const SurfaceQuery query(body.mesh);
    return std::erase_if(points, [&](const Vec3d& point) {
        const Vec3d local = body.start.to_body(point);
        return query.bounds().contains(local) && query.inside(local);
    });
}

} // namespace

void check_fluid(const SceneFile& scene, PreparedScene& prepared)
{
    if (prepared.fluid_particles > kMostPointsToCount) return;
    std::vector<Vec3d> points = fluid_points(scene, prepared);
    for (const PreparedBody& body : prepared.bodies)
        if (const std::size_t cut = cut_by(body, points); cut > 0)
            prepared.notes.push_back("the fluid overlaps " + body.name + ", which cuts away about " +
                                     std::to_string(cut) + " particles");
    prepared.fluid_particles = static_cast<double>(points.size());
    if (points.empty())
        throw InputError(scene.file.string() + ": no fluid is left within the walls and outside the bodies; "
                                               "a block must be at least a particle spacing wide");
}

void check_probes(const SceneFile& scene, PreparedScene& prepared)
{
    Aabb world;
    const auto add = [&](const Aabb& box) {
        world.extend(box.min);
        world.extend(box.max);
    };
    for (const SceneBlock& block : prepared.blocks) add(block.box);
    for (const TriangleMesh& mesh : prepared.fluid_meshes) add(bounds(mesh));
    for (const PreparedWall& wall : prepared.walls) add(bounds(wall.mesh));
    for (std::size_t k = 0; k < scene.probes.size(); ++k) {
        const SceneProbe& probe = scene.probes[k];
        const bool is_level = probe.kind == SceneProbe::Kind::level;
        Vec3d point = probe.point;
        if (is_level) point.z() = world.center().z();
        if (!world.contains(point))
            prepared.notes.push_back("probes[" + std::to_string(k) + "] (\"" + probe.name +
                                     "\") is outside of all walls and fluid, where " +
                                     (is_level ? "there is no level" : "the pressure is 0"));
    }
}

} // namespace scene

SceneCheck check_scene(const SceneFile& scene)
{
    const scene::PreparedScene prepared = scene::prepare_and_check(scene);
    SceneCheck check;
    check.notes = prepared.notes;
    check.fluid_particles = prepared.fluid_particles;
    check.boundary_samples = prepared.boundary_samples;
    check.memory_bytes = prepared.memory_bytes;
    for (std::size_t k = 0; k < prepared.bodies.size(); ++k) {
        const scene::PreparedBody& body = prepared.bodies[k];
        check.bodies.push_back(
            {scene.bodies[k].name, body.volume, body.mass, body.mass / body.volume / scene.fluid.density});
    }
    return check;
}

} // namespace flotsam
