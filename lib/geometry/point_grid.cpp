#include "geometry/point_grid.hpp"

#include <bit>

namespace flotsam {

void PointGrid::reserve(std::size_t points)
{
    starts_.reserve(std::bit_ceil(points + 1) * 2 + 1);
    entries_.reserve(points);
}

void PointGrid::build(std::span<const Vec3d> points, double cell)
{
    inv_cell_ = 1.0 / cell;
    mask_ = std::bit_ceil(points.size() + 1) * 2 - 1;
    starts_.assign(mask_ + 2, 0);
    entries_.resize(points.size());
    const auto bucket = [&](const Vec3d& p) { return bucket_of(key_of(cell_of(p))); };
    for (const Vec3d& p : points) ++starts_[bucket(p)];
    for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
    // Each bucket from its end, so that its points stand in the order of their indices.
    for (std::size_t i = points.size(); i-- > 0;) {
        const std::uint64_t key = key_of(cell_of(points[i]));
        entries_[--starts_[bucket_of(key)]] = {points[i], key, static_cast<std::uint32_t>(i)};
    }
}

} // namespace flotsam
