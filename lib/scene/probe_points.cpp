#include "scene/probe_points.hpp"

#include <algorithm>

namespace flotsam::scene {

std::vector<Vec3d> surface_points(const TriangleMesh& mesh, double spacing)
{
    return refined(mesh, std::max(spacing, bounds(mesh).size().maxCoeff() / 64.0)).vertices;
}

std::vector<Vec3d> grid_in(const Aabb& box)
{
    constexpr int kPerAxis = 8;
    std::vector<Vec3d> points;
    for (int n = 0; n < kPerAxis * kPerAxis * kPerAxis; ++n) {
        const Vec3d fraction(n % kPerAxis + 0.5, n / kPerAxis % kPerAxis + 0.5, n / kPerAxis / kPerAxis + 0.5);
        points.push_back(box.min + (box.size().array() * fraction.array() / kPerAxis).matrix());
    }
    return points;
}

std::vector<Vec3d> inner_points(const SurfaceQuery& solid, double depth)
{
    std::vector<Vec3d> points = grid_in(solid.bounds());
    std::erase_if(points, [&](const Vec3d& point) { return solid.signed_distance(point) >= -depth; });
    return points;
}

} // namespace flotsam::scene
