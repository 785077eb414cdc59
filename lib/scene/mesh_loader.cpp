#include "scene/mesh_loader.hpp"

#include "flotsam/geometry/mesh_check.hpp"
#include "scene/refuse.hpp"

#include <algorithm>

namespace flotsam::scene {

TriangleMesh MeshLoader::solid(const SceneMesh& source, const std::string& place) const
{
    return load(source, place, true, scene_.particle_spacing).first;
}

std::pair<TriangleMesh, bool> MeshLoader::wall(const SceneMesh& source, const std::string& place) const
{
    auto [mesh, closed] = load(source, place, false, 0.0);
    const Vec3d size = bounds(mesh).size();
    if (size.maxCoeff() < 2.0 * scene_.particle_spacing)
        refuse(scene_, place, ": ", source.file.string(), " measures ", size.x(), " x ", size.y(), " x ", size.z(),
               " m, and must be at least 2 particle spacings (", 2.0 * scene_.particle_spacing,
               " m) long; is its scale right?");
    return {std::move(mesh), closed};
}

std::pair<TriangleMesh, bool> MeshLoader::load(const SceneMesh& source, const std::string& place, bool must_be_closed,
                                               double spacing) const
{
    try {
        TriangleMesh mesh = load_mesh(source.file, source.options);
        const MeshCheckReport report = check_mesh(
            mesh, {.name = source.file.string(), .must_be_closed = must_be_closed, .particle_spacing = spacing});
        for (const std::string& note : report.notes)
            if (std::find(prepared_.notes.begin(), prepared_.notes.end(), note) == prepared_.notes.end())
                prepared_.notes.push_back(note);
        return {std::move(mesh), report.closed};
    } catch (const InputError& error) {
        refuse(scene_, place, ": ", error.what());
    }
}

} // namespace flotsam::scene
