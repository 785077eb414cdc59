#include "scene/prepared_scene.hpp"

#include "scene/memory_need.hpp"
#include "scene/mesh_loader.hpp"
#include "scene/refuse.hpp"
#include "scene/tanks.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>
#include <utility>

namespace flotsam::scene {
namespace {

/// Positions are single precision: further away, their digits are too few for forces between neighbours.
void refuse_far(const SceneFile& scene, const std::string& name, const Aabb& box)
{
    constexpr double kFarthest = 1e5; // [spacings]
    Vec3d corner = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs());
    if (scene.dimensions == 2) corner.y() = 0.0;
    const double reach = corner.maxCoeff();
    if (reach > kFarthest * scene.particle_spacing)
        refuse(scene, name, " reaches ", reach,
               " m away from the origin, and must stay within 100000 particle spacings (",
               kFarthest * scene.particle_spacing, " m) of it");
}

// -- fluid and walls ----------------------------------------------------------------------------------------------

/// The block within the closed sides of the box.
Aabb clipped(Aabb block, const SceneWall& wall)
{
    const auto closed = [&](const char* side) {
        return std::find(wall.open.begin(), wall.open.end(), side) == wall.open.end();
    };
    const std::array low{"-x", "-y", "-z"}, high{"+x", "+y", "+z"};
    for (int axis = 0; axis < 3; ++axis) {
        if (closed(low[static_cast<std::size_t>(axis)]))
            block.min[axis] = std::max(block.min[axis], wall.box.min[axis]);
        if (closed(high[static_cast<std::size_t>(axis)]))
            block.max[axis] = std::min(block.max[axis], wall.box.max[axis]);
    }
    return block;
}

/// What of the block is in each tank; all of it where there is no box wall.
std::vector<Aabb> within_tanks(const Aabb& block, const SceneFile& scene,
                               const std::vector<std::vector<std::size_t>>& tanks)
{
    if (tanks.empty()) return {block};
    std::vector<Aabb> parts;
    for (const std::vector<std::size_t>& tank : tanks) {
        Aabb part = block;
        for (const std::size_t wall : tank) part = clipped(part, scene.walls[wall]);
        if (!part.empty() && part.size().minCoeff() > 0.0) parts.push_back(part);
    }
    return parts;
}

void add_blocks(const SceneFile& scene, PreparedScene& prepared)
{
    const std::vector<std::vector<std::size_t>> tanks = tanks_of_boxes(scene);
    for (std::size_t k = 0; k < scene.fluid.blocks.size(); ++k) {
        const SceneBlock& given = scene.fluid.blocks[k];
        const std::vector<Aabb> parts = within_tanks(given.box, scene, tanks);
        const std::string name = "fluids[0].blocks[" + std::to_string(k) + "]";
        if (parts.empty() || !(given.box.size().minCoeff() > 0.0)) {
            prepared.notes.push_back(name + " lies outside the walls and was left out");
            continue;
        }
        double left = 0.0;
        for (const Aabb& part : parts) {
            SceneBlock block = given;
            block.box = part;
            prepared.blocks.push_back(block);
            left += part.size().prod() / given.box.size().prod();
        }
        if (left < 1.0 - 1e-9) {
            std::ostringstream note;
            note.precision(3);
            note << name << " reaches through the walls; the " << 100.0 * (1.0 - left) << " % outside were cut away";
            prepared.notes.push_back(note.str());
        }
    }
}

void add_fluid_meshes(const SceneFile& scene, PreparedScene& prepared)
{
    const std::vector<std::vector<std::size_t>> tanks = tanks_of_boxes(scene);
    for (std::size_t k = 0; k < scene.fluid.meshes.size(); ++k) {
        const SceneFluidMesh& fluid = scene.fluid.meshes[k];
        const std::string place = "fluids[0].meshes[" + std::to_string(k) + "]";
        prepared.fluid_meshes.push_back(transformed(MeshLoader(scene, prepared).solid(fluid.mesh, place), fluid.pose));
        if (within_tanks(bounds(prepared.fluid_meshes.back()), scene, tanks).empty())
            prepared.notes.push_back(place + " lies outside the walls, which cut away all of it");
    }
}

void add_walls(const SceneFile& scene, PreparedScene& prepared)
{
    for (std::size_t k = 0; k < scene.walls.size(); ++k) {
        const SceneWall& wall = scene.walls[k];
        PreparedWall made;
        const std::string place = "walls[" + std::to_string(k) + "]";
        made.name = place + (wall.name.empty() ? "" : " (\"" + wall.name + "\")");
        if (wall.mesh) {
            std::tie(made.mesh, made.closed) = MeshLoader(scene, prepared).wall(*wall.mesh, place + ".mesh");
            made.mesh = transformed(std::move(made.mesh), wall.pose);
        } else {
            made.mesh = container_box(wall.box, wall.open);
        }
        prepared.walls.push_back(std::move(made));
    }
}

} // namespace

PreparedScene prepare_scene(const SceneFile& scene)
{
    PreparedScene prepared;
    add_blocks(scene, prepared);
    add_walls(scene, prepared);
    check_gaps_of_tanks(scene, prepared);
    add_fluid_meshes(scene, prepared);
    refuse_too_many_particles(scene, prepared); // before bodies are cut into triangles as small as the particles
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) prepared.bodies.push_back(prepare_body(scene, k, prepared));
    refuse_too_many_particles(scene, prepared);
    return prepared;
}

void check_reach(const SceneFile& scene, const PreparedScene& prepared)
{
    for (const SceneBlock& block : prepared.blocks) refuse_far(scene, "a block of fluid", block.box);
    for (const TriangleMesh& mesh : prepared.fluid_meshes) refuse_far(scene, "a mesh of fluid", bounds(mesh));
    for (const PreparedWall& wall : prepared.walls) refuse_far(scene, wall.name, bounds(wall.mesh));
    for (const PreparedBody& body : prepared.bodies)
        refuse_far(scene, body.name, bounds(transformed(body.mesh, body.start)));
    for (std::size_t k = 0; k < scene.joints.size(); ++k)
        refuse_far(scene, "joints[" + std::to_string(k) + "] (\"" + scene.joints[k].name + "\")",
                   {scene.joints[k].point, scene.joints[k].point});
}

PreparedScene prepare_and_check(const SceneFile& scene)
{
    PreparedScene prepared = prepare_scene(scene);
    if (scene.start == FluidWorldSettings::Start::at_rest) float_bodies(scene, prepared);
    check_bodies(scene, prepared);
    check_reach(scene, prepared);
    check_fluid(scene, prepared);
    check_probes(scene, prepared);
    return prepared;
}

} // namespace flotsam::scene
