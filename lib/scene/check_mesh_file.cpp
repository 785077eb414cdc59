#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "flotsam/scene/check_scene.hpp"

namespace flotsam {
namespace {

bool can_be_wall(TriangleMesh mesh)
{
    try {
        static_cast<void>(check_mesh(mesh, {.must_be_closed = false}));
        return true;
    } catch (const InputError&) {
        return false;
    }
}

} // namespace

MeshFileCheck check_mesh_file(const std::filesystem::path& file)
{
    TriangleMesh mesh = load_mesh(file);
    const TriangleMesh as_read = mesh;
    MeshCheckReport report;
    try {
        report = check_mesh(mesh, {.name = file.string()});
    } catch (const InputError& error) {
        if (!can_be_wall(as_read)) throw;
        throw InputError(error.what() + std::string("; it can be a wall only"));
    }
    const MassProperties solid = mass_properties(mesh);
    return {report.notes, mesh.triangles.size(), report.parts, bounds(mesh), solid.volume, solid.center_of_mass};
}

} // namespace flotsam
