#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// Uniform grid of cubic cells. They are numbered in layers across the longest axis, so that cells that touch are as
/// few numbers apart as can be, and in a layer in rows along the longer of the other two. Points outside are taken into
/// the cell at the border: two points closer than a cell still fall into the same or adjacent cells, so no neighbour is
/// lost, only speed.
struct CellGrid {
    Vec3 origin = Vec3::Zero(); ///< low corner [m]
    Scalar inv_cell = 1;        ///< 1 / edge of a cell [1/m]
    Eigen::Vector3i cells = Eigen::Vector3i::Ones();
    std::array<int, 3> axes = {0, 1, 2}; ///< along a row, from row to row, from layer to layer

    /// Grid of cells of edge `cell` around the points of both sets, at most `max_cells` of them.
    static CellGrid around(std::span<const Vec4> a, std::span<const Vec4> b, double cell, std::size_t max_cells);

    [[nodiscard]] std::size_t size() const
    {
        return static_cast<std::size_t>(cells.x()) * static_cast<std::size_t>(cells.y()) *
               static_cast<std::size_t>(cells.z());
    }
    [[nodiscard]] Eigen::Vector3i cell_of(const Vec4& p) const
    {
        const auto axis = [&](int k) {
            const Scalar c = (p[k] - origin[k]) * inv_cell;
            const Scalar last = static_cast<Scalar>(cells[k] - 1);
            return static_cast<int>(c > Scalar(0) ? (c < last ? c : last) : Scalar(0)); // NaN goes to 0
        };
        return {axis(0), axis(1), axis(2)};
    }
    [[nodiscard]] std::uint32_t index_of(const Eigen::Vector3i& c) const
    {
        return static_cast<std::uint32_t>(c[axes[0]] + cells[axes[0]] * (c[axes[1]] + cells[axes[1]] * c[axes[2]]));
    }
    /// Calls visit(first, last) for each row of the cells that are within `reach` cells of the cell `home`.
    template <class Visit>
    void visit_rows(const Eigen::Vector3i& home, int reach, Visit&& visit) const
    {
        const auto [along, row, layer] = axes;
        const Eigen::Vector3i low = (home.array() - reach).max(0), high = (home.array() + reach).min(cells.array() - 1);
        Eigen::Vector3i first = low;
        for (first[layer] = low[layer]; first[layer] <= high[layer]; ++first[layer]) {
            for (first[row] = low[row]; first[row] <= high[row]; ++first[row]) {
                const std::uint32_t number = index_of(first);
                visit(number, number + static_cast<std::uint32_t>(high[along] - low[along]));
            }
        }
    }
};

/// Points listed by cell: those of cell c are order[start[c]] .. order[start[c + 1]], in rising order.
struct CellLists {
    static constexpr std::size_t kSlack = 8; ///< entries behind the last one, so that whole registers can be loaded

    std::vector<std::uint32_t> start;
    std::vector<std::uint32_t> order; ///< with slack
    std::vector<std::uint32_t> cell;  ///< of each point; free to be written over when all is built
    std::vector<Scalar> x, y, z;      ///< of the points, in this order, with slack

    void build(const CellGrid& grid, std::span<const Vec4> points, const Workers& workers);
};

} // namespace flotsam
