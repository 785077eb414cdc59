#include "world/usable_mesh.hpp"

#include "flotsam/geometry/mass_properties.hpp"

#include <sstream>
#include <stdexcept>

namespace flotsam {
namespace {

template <class... Words>
[[noreturn]] void refuse(const Words&... words)
{
    std::ostringstream sentence;
    (sentence << ... << words);
    throw std::invalid_argument(sentence.str());
}

} // namespace

void require_surface(const TriangleMesh& mesh, std::string_view what)
{
    if (mesh.empty()) refuse(what, " needs at least one triangle");
    const auto vertices = static_cast<int>(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const int v : mesh.triangles[t])
            if (v < 0 || v >= vertices)
                refuse(what, " must have triangles between its vertices 0 to ", vertices - 1, ", triangle ", t,
                       " names vertex ", v);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!mesh.vertices[v].allFinite())
            refuse(what, " must have finite vertices [m], vertex ", v, " is at ", mesh.vertices[v].transpose());
}

void require_solid(const TriangleMesh& mesh, std::string_view what)
{
    require_surface(mesh, what);
    const double volume = mass_properties(mesh).volume;
    if (!(volume > 0.0))
        refuse(what, " must enclose a volume > 0 with triangles that face outward [m^3], given ", volume);
}

bool is_closed(const TriangleMesh& mesh)
{
    // Every directed edge has its reverse: the sum of the triangles' area vectors vanishes for a closed surface.
    Vec3d sum = Vec3d::Zero();
    double area = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d part = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
        sum += part;
        area += part.norm();
    }
    return sum.norm() < 1e-6 * area;
}

} // namespace flotsam
