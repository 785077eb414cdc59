#include "geometry/basin_query.hpp"

#include "geometry/plane_cut.hpp"

#include <algorithm>

namespace flotsam {

BasinQuery::BasinQuery(const TriangleMesh& closed, const Pose& pose, double water_level)
    : is_basin_(basins(closed, pose, water_level))
{
    if (std::find(is_basin_.begin(), is_basin_.end(), 1) == is_basin_.end()) return;
    surface_.emplace(transformed(closed, pose));
}

bool BasinQuery::holds(const Vec3d& point, double slack) const
{
    if (empty() || !surface_->bounds().contains(point)) return false;
    if (slack > 0.0) {
        const SurfaceQuery::Closest closest = surface_->closest(point);
        if (closest.distance < slack) return is_basin_[static_cast<std::size_t>(closest.triangle)] != 0;
    }
    const auto hit = surface_->sweep(point, Vec3d(point.x(), point.y(), surface_->bounds().min.z() - 1.0));
    return hit && is_basin_[static_cast<std::size_t>(hit->triangle)] != 0;
}

TriangleMesh hull_of(const TriangleMesh& closed, int dimensions)
{
    return dimensions == 3 ? closed : ribbon(cut_at_y0(closed), 0.5);
}

} // namespace flotsam
