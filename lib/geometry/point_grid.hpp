#pragma once

#include "flotsam/core/types.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// Points sorted into the cells of an unbounded hashed grid. The order of visits depends on the points only.
class PointGrid {
  public:
    PointGrid() = default;
    PointGrid(std::span<const Vec3d> points, double cell) { build(points, cell); }
    /// Room for so many points.
    void reserve(std::size_t points);
    /// Replaces the points; room is kept.
    void build(std::span<const Vec3d> points, double cell);

    /// Calls visit(index, squared distance) for each point within `radius` <= cell of `center`.
    template <class Visit>
    void for_near(const Vec3d& center, double radius, Visit&& visit) const
    {
        const Cell low = cell_of(center - Vec3d::Constant(radius)), high = cell_of(center + Vec3d::Constant(radius));
        const double radius_sq = radius * radius;
        for (std::int64_t z = low[2]; z <= high[2]; ++z)
            for (std::int64_t y = low[1]; y <= high[1]; ++y)
                for (std::int64_t x = low[0]; x <= high[0]; ++x)
                    for_cell({x, y, z}, [&](const Entry& entry) {
                        const double distance_sq = (entry.point - center).squaredNorm();
                        if (distance_sq <= radius_sq) visit(entry.index, distance_sq);
                    });
    }

    /// Distance to the nearest point within `radius` <= cell, or `radius`.
    [[nodiscard]] double nearest(const Vec3d& center, double radius) const
    {
        double best_sq = radius * radius;
        for_near(center, radius, [&](std::size_t, double distance_sq) { best_sq = std::min(best_sq, distance_sq); });
        return std::sqrt(best_sq);
    }

  private:
    using Cell = std::array<std::int64_t, 3>;
    struct Entry {
        Vec3d point;
        std::uint64_t key;
        std::uint32_t index;
    };

    [[nodiscard]] Cell cell_of(const Vec3d& p) const
    {
        return {static_cast<std::int64_t>(std::floor(p.x() * inv_cell_)),
                static_cast<std::int64_t>(std::floor(p.y() * inv_cell_)),
                static_cast<std::int64_t>(std::floor(p.z() * inv_cell_))};
    }
    /// The same for cells 2^21 apart only, which no search reaches.
    static std::uint64_t key_of(const Cell& c)
    {
        constexpr std::uint64_t bits = (std::uint64_t{1} << 21) - 1;
        return (static_cast<std::uint64_t>(c[0]) & bits) | (static_cast<std::uint64_t>(c[1]) & bits) << 21 |
               (static_cast<std::uint64_t>(c[2]) & bits) << 42;
    }
    [[nodiscard]] std::size_t bucket_of(std::uint64_t key) const
    {
        const std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
        return static_cast<std::size_t>((mixed ^ (mixed >> 32)) & mask_);
    }
    template <class Visit>
    void for_cell(const Cell& cell, Visit&& visit) const
    {
        const std::uint64_t key = key_of(cell);
        const std::size_t bucket = bucket_of(key);
        for (std::size_t k = starts_[bucket]; k < starts_[bucket + 1]; ++k)
            if (entries_[k].key == key) visit(entries_[k]);
    }

    double inv_cell_ = 1.0;
    std::uint64_t mask_ = 0;
    std::vector<std::uint32_t> starts_ = {0, 0};
    std::vector<Entry> entries_;
};

} // namespace flotsam
