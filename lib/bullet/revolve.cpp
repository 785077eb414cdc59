#include "bullet/revolve.hpp"

#include "flotsam/geometry/mass_properties.hpp"

#include <cmath>
#include <numbers>

namespace flotsam {

namespace {

void add_ring(TriangleMesh& mesh, const ProfilePoint& point, int segments)
{
    for (int k = 0; k < segments; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / segments;
        mesh.vertices.emplace_back(point.radius * std::cos(angle), point.radius * std::sin(angle), point.z);
    }
}

} // namespace

TriangleMesh revolved(const std::vector<ProfilePoint>& profile, int segments, double volume)
{
    TriangleMesh mesh;
    const int rings = static_cast<int>(profile.size()) - 2;
    for (int ring = 1; ring <= rings; ++ring) add_ring(mesh, profile[static_cast<std::size_t>(ring)], segments);
    const int bottom = rings * segments, top = bottom + 1;
    mesh.vertices.emplace_back(0.0, 0.0, profile.front().z);
    mesh.vertices.emplace_back(0.0, 0.0, profile.back().z);

    for (int k = 0; k < segments; ++k) {
        const int next = (k + 1) % segments;
        mesh.triangles.push_back({bottom, next, k});
        for (int low = 0, high = segments; high < bottom; low = high, high += segments) {
            mesh.triangles.push_back({low + k, low + next, high + next});
            mesh.triangles.push_back({low + k, high + next, high + k});
        }
        mesh.triangles.push_back({bottom - segments + k, bottom - segments + next, top});
    }

    const double stretch = std::sqrt(volume / mass_properties(mesh).volume);
    for (Vec3d& vertex : mesh.vertices) vertex.head<2>() *= stretch;
    return mesh;
}

} // namespace flotsam
