#include "scene/solid_file.hpp"

#include "flotsam/core/contracts.hpp"

namespace flotsam::scene {
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

SolidFile read_solid(const std::filesystem::path& file, const MeshFileOptions& options)
{
    SolidFile solid;
    solid.mesh = load_mesh(file, options);
    const TriangleMesh as_read = solid.mesh;
    try {
        solid.report = check_mesh(solid.mesh, {.name = file.string()});
    } catch (const InputError& error) {
        if (!can_be_wall(as_read)) throw;
        throw InputError(error.what() + std::string("; it can be a wall only"));
    }
    return solid;
}

} // namespace flotsam::scene
