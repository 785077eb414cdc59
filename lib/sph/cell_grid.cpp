#include "flotsam/sph/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flotsam {

CellGrid CellGrid::around(std::span<const Vec4> a, std::span<const Vec4> b, double cell, std::size_t max_cells)
{
    Vec4 low = Vec4::Constant(Scalar(1e30)), high = Vec4::Constant(Scalar(-1e30));
    for (const std::span<const Vec4> points : {a, b}) {
        for (const Vec4& p : points) {
            if (!p.allFinite()) continue; // reported by the step; must not blow the grid up
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    CellGrid grid;
    grid.inv_cell = static_cast<Scalar>(1.0 / cell);
    if (!(low.array() <= high.array()).all()) return grid;
    grid.origin = low.head<3>() - Vec3::Constant(static_cast<Scalar>(0.01 * cell));
    const auto max_along = [&](double budget, double extent) {
        return static_cast<int>(std::clamp(std::floor(extent / cell) + 1.0, 1.0, std::max(1.0, budget)));
    };
    // A few far particles must not cost memory: the widest axes give way first, the border cells take what is beyond.
    const Vec3d extent = (high - low).head<3>().cast<double>() + Vec3d::Constant(0.02 * cell);
    double budget = static_cast<double>(max_cells);
    std::array<int, 3> axes = {0, 1, 2}; // shortest first
    std::sort(axes.begin(), axes.end(), [&](int x, int y) { return extent[x] < extent[y]; });
    for (int k = 0; k < 3; ++k) {
        const double share = std::pow(budget, 1.0 / (3 - k));
        grid.cells[axes[static_cast<std::size_t>(k)]] = max_along(share, extent[axes[static_cast<std::size_t>(k)]]);
        budget /= grid.cells[axes[static_cast<std::size_t>(k)]];
    }
    std::sort(axes.begin(), axes.end(),
              [&](int x, int y) { return std::pair(grid.cells[x], x) < std::pair(grid.cells[y], y); });
    grid.axes = {axes[1], axes[0], axes[2]};
    return grid;
}

void CellLists::build(const CellGrid& grid, std::span<const Vec4> points, const Workers& workers)
{
    const std::size_t count = points.size();
    cell.resize(count);
    order.resize(count + kSlack);
    for (auto* axis : {&x, &y, &z}) axis->resize(count + kSlack);
    if (start.capacity() <= grid.size()) start.reserve(2 * grid.size() + 1); // a splash widens the grid step by step
    start.assign(grid.size() + 1, 0);
    workers.for_each(count, [&](std::size_t i) { cell[i] = grid.index_of(grid.cell_of(points[i])); });
    for (std::size_t i = 0; i < count; ++i) ++start[cell[i] + 1];
    for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
    // Filling moves each start to the next cell's; shifting by one place afterwards restores them.
    for (std::size_t i = 0; i < count; ++i) order[start[cell[i]]++] = static_cast<std::uint32_t>(i);
    std::copy_backward(start.begin(), start.end() - 1, start.end());
    start[0] = 0;
    workers.for_each(count, [&](std::size_t k) {
        const Vec4& p = points[order[k]];
        x[k] = p[0];
        y[k] = p[1];
        z[k] = p[2];
    });
}

} // namespace flotsam
