#include "geometry/point_grid.hpp"

#include <bit>

namespace flotsam {

PointGrid::PointGrid(std::span<const Vec3d> points, double cell)
    : inv_cell_(1.0 / cell), mask_(std::bit_ceil(points.size() + 1) * 2 - 1), starts_(mask_ + 2, 0),
      entries_(points.size())
{
    for (const Vec3d& p : points) ++starts_[bucket_of(key_of(cell_of(p))) + 1];
    for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::uint64_t key = key_of(cell_of(points[i]));
        entries_[next[bucket_of(key)]++] = {points[i], key, i};
    }
}

} // namespace flotsam
