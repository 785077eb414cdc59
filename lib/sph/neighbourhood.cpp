#include "flotsam/sph/neighbourhood.hpp"

#include "flotsam/core/contracts.hpp"
#include "sph/simd/search_passes.hpp"

#include <algorithm>
#include <atomic>
#include <limits>

namespace flotsam {
namespace {

void find_starts(const simd::Search& search, const Workers& workers, std::vector<std::uint32_t>& start)
{
    const std::size_t count = search.points.size();
    start.resize(count + 1);
    start[0] = 0;
    workers.for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::count_neighbours(search, begin, end, start.data() + begin + 1);
    });
    for (std::size_t i = 0; i < count; ++i) start[i + 1] += start[i];
}

/// For `size` values and `slack` zeroes behind them. Twice as many are reserved, so that spreading water soon needs no
/// more; pages that are never written cost no memory.
template <class T>
void make_room(std::size_t size, std::size_t slack, std::vector<T>& values)
{
    const std::size_t total = size + slack;
    if (values.capacity() < total) values.reserve(2 * total);
    values.resize(total);
    std::fill(values.end() - static_cast<std::ptrdiff_t>(slack), values.end(), T(0));
}

} // namespace

void NeighbourSearch::find_distances(Scalar support, const CellGrid& grid, const CellLists& lists,
                                     std::span<const Vec4> points, bool same, const Workers& workers, Pairs& pairs)
{
    FLOTSAM_ASSERT(grid.inv_cell * support <= Scalar(1.001), "a cell must be at least one support radius wide");
    const simd::Search search{&grid, &lists, points, same, support};
    const std::size_t count = points.size();
    find_starts(search, workers, pairs.start);
    pairs.kernel_sum.resize(count);
    make_room(pairs.start[count], Pairs::kSlack, pairs.index);
    make_room(pairs.start[count], Pairs::kSlack, pairs.slope);
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

template <class Spline>
void NeighbourSearch::find_among(const Spline& kernel, const CellGrid& grid, const CellLists& lists,
                                 std::span<const Vec4> points, const Workers& workers, SelfPairs& pairs)
{
    FLOTSAM_ASSERT(grid.inv_cell * kernel.support() <= Scalar(1.001),
                   "a cell must be at least one support radius wide");
    constexpr std::uint32_t kFarthest = std::numeric_limits<std::int16_t>::max();
    const simd::Search search{&grid, &lists, points, true, kernel.support()};
    find_starts(search, workers, pairs.start);
    const std::size_t count = points.size(), size = pairs.start[count];
    pairs.unit = kernel.steepest() / SelfPairs::kParts;
    pairs.kernel_sum.resize(count);
    make_room(size, SelfPairs::kSlack, pairs.parts);
    const auto write = [&] {
        std::atomic<std::uint32_t> reach = 0;
        workers.for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) {
            const std::uint32_t of_chunk = simd::write_self_pairs(search, kernel, begin, end, pairs);
            std::uint32_t before = reach;
            while (before < of_chunk && !reach.compare_exchange_weak(before, of_chunk)) {
            }
        });
        return reach.load();
    };
    if (!pairs.is_far()) {
        make_room(size, SelfPairs::kSlack, pairs.offset);
        if (write() <= kFarthest) return;
        pairs.offset = {};
    }
    make_room(size, SelfPairs::kSlack, pairs.index);
    // Not at the first step that would do with less: water that sloshes about the limit would be written twice.
    if (write() < kFarthest / 4 * 3)
        pairs.index = {};
    else
        return;
    make_room(size, SelfPairs::kSlack, pairs.offset);
    write();
}

void NeighbourSearch::find(const QuinticSpline& kernel, const CellGrid& grid, const CellLists& lists,
                           std::span<const Vec4> points, const Workers& workers, SelfPairs& pairs)
{
    find_among(kernel, grid, lists, points, workers, pairs);
}

void NeighbourSearch::find(const CubicSpline& kernel, const CellGrid& grid, const CellLists& lists,
                           std::span<const Vec4> points, const Workers& workers, SelfPairs& pairs)
{
    find_among(kernel, grid, lists, points, workers, pairs);
}

} // namespace flotsam
