#include "flotsam/sph/neighbourhood.hpp"

#include "flotsam/core/contracts.hpp"
#include "sph/simd/search_passes.hpp"

#include <algorithm>

namespace flotsam {

void NeighbourSearch::find_distances(Scalar support, const CellGrid& grid, const CellLists& lists,
                                     std::span<const Vec4> points, bool same, const Workers& workers, Pairs& pairs)
{
    FLOTSAM_ASSERT(grid.inv_cell * support <= Scalar(1.001), "a cell must be at least one support radius wide");
    const simd::Search search{&grid, &lists, points, same, support};
    const std::size_t count = points.size();
    pairs.start.resize(count + 1);
    pairs.start[0] = 0;
    pairs.kernel_sum.resize(count);
    workers.for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::count_neighbours(search, begin, end, pairs.start.data() + begin + 1);
    });
    for (std::size_t i = 0; i < count; ++i) pairs.start[i + 1] += pairs.start[i];
    const std::size_t total = pairs.start[count] + Pairs::kSlack;
    // Twice as many, so that spreading water soon needs no more; pages that are never written cost no memory.
    if (pairs.index.capacity() < total) pairs.index.reserve(2 * total);
    if (pairs.slope.capacity() < total) pairs.slope.reserve(2 * total);
    pairs.index.resize(total);
    pairs.slope.resize(total);
    std::fill(pairs.index.end() - Pairs::kSlack, pairs.index.end(), 0);
    std::fill(pairs.slope.end() - Pairs::kSlack, pairs.slope.end(), Scalar(0));
    workers.for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::write_neighbours(search, begin, end, pairs);
    });
}

template <class Spline>
void NeighbourSearch::find_with(const Spline& kernel, const CellGrid& grid, const CellLists& lists,
                                std::span<const Vec4> points, bool same, std::span<const Scalar> weights,
                                const Workers& workers, Pairs& pairs)
{
    find_distances(kernel.support(), grid, lists, points, same, workers, pairs);
    workers.for_chunks(points.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::evaluate_kernel(kernel, weights, begin, end, pairs);
    });
}

void NeighbourSearch::find(const QuinticSpline& kernel, const CellGrid& grid, const CellLists& lists,
                           std::span<const Vec4> points, bool same, std::span<const Scalar> weights,
                           const Workers& workers, Pairs& pairs)
{
    find_with(kernel, grid, lists, points, same, weights, workers, pairs);
}

void NeighbourSearch::find(const CubicSpline& kernel, const CellGrid& grid, const CellLists& lists,
                           std::span<const Vec4> points, bool same, std::span<const Scalar> weights,
                           const Workers& workers, Pairs& pairs)
{
    find_with(kernel, grid, lists, points, same, weights, workers, pairs);
}

} // namespace flotsam
