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
    PointGrid(std::span<const Vec3d> points, double cell);

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
        Cell cell;
        std::size_t index;
    };

    [[nodiscard]] Cell cell_of(const Vec3d& p) const
    {
        return {static_cast<std::int64_t>(std::floor(p.x() * inv_cell_)),
                static_cast<std::int64_t>(std::floor(p.y() * inv_cell_)),
                static_cast<std::int64_t>(std::floor(p.z() * inv_cell_))};
    }
    [[nodiscard]] std::size_t bucket_of(const Cell& c) const
    {
        const std::uint64_t mixed = static_cast<std::uint64_t>(c[0]) * 0x9e3779b97f4a7c15ULL ^
                                    static_cast<std::uint64_t>(c[1]) * 0xc2b2ae3d27d4eb4fULL ^
                                    static_cast<std::uint64_t>(c[2]) * 0x165667b19e3779f9ULL;
        return static_cast<std::size_t>((mixed ^ (mixed >> 32)) & mask_);
    }
    template <class Visit>
    void for_cell(const Cell& cell, Visit&& visit) const
    {
        const std::size_t bucket = bucket_of(cell);
        for (std::size_t k = starts_[bucket]; k < starts_[bucket + 1]; ++k)
            if (entries_[k].cell == cell) visit(entries_[k]);
    }

    double inv_cell_;
    std::uint64_t mask_;
    std::vector<std::size_t> starts_;
    std::vector<Entry> entries_;
};

} // namespace flotsam
