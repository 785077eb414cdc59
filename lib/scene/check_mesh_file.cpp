#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/scene/check_scene.hpp"
#include "scene/solid_file.hpp"

namespace flotsam {

MeshFileCheck check_mesh_file(const std::filesystem::path& file)
{
    const auto [mesh, report] = scene::read_solid(file);
    const MassProperties solid = mass_properties(mesh);
    return {report.notes, mesh.triangles.size(), report.parts, bounds(mesh), solid.volume, solid.center_of_mass};
}

} // namespace flotsam
