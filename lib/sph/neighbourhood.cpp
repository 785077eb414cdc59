#include "flotsam/sph/neighbourhood.hpp"

#include "flotsam/core/contracts.hpp"
#include "sph/simd/search_passes.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <numeric>

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

/// The turn of each chunk of a loop, in the order of the chunks: what comes before it is known then.
class ChunkOrder {
  public:
    /// Chunks are to be started in their order.
    std::size_t next() { return next_.fetch_add(1, std::memory_order_relaxed); }
    /// Waits for the turn of a chunk; false where one before it has failed.
    bool wait_for(std::size_t chunk)
    {
        for (std::size_t turn = turn_; turn != chunk; turn = turn_) {
            if (turn == kFailed) return false;
            turn_.wait(turn);
        }
        return true;
    }
    /// Ends a chunk's turn.
    void pass_on(std::size_t chunk)
    {
        if (turn_.compare_exchange_strong(chunk, chunk + 1)) turn_.notify_all(); // unless one has failed meanwhile
    }
    void fail()
    {
        turn_ = kFailed;
        turn_.notify_all();
    }

  private:
    static constexpr std::size_t kFailed = std::numeric_limits<std::size_t>::max();
    std::atomic<std::size_t> next_ = 0, turn_ = 0;
};

/// As large a part of all rows as there is room for, and the starts of all; returns the largest |j - i|.
template <class Spline>
std::uint32_t write_rows(const simd::Search& search, const Spline& kernel, std::size_t room, const Workers& workers,
                         std::span<SelfRows> rows_of_threads, SelfPairs& pairs)
{
    const std::size_t count = search.points.size(), chunks = Workers::chunk_count(count);
    pairs.start.resize(count + 1);
    pairs.start[0] = 0;
    ChunkOrder order;
    std::uint32_t total = 0, reach = 0; // of the chunks whose turn has been
    const auto write_chunk = [&](std::size_t chunk, SelfRows& rows) {
        const std::size_t begin = chunk * Workers::kChunk, end = std::min(count, begin + Workers::kChunk);
        const std::uint32_t of_chunk = simd::find_self_rows(search, kernel, begin, end, rows, pairs);
        const std::uint32_t size = std::accumulate(rows.length.begin(), rows.length.end(), std::uint32_t(0));
        if (!order.wait_for(chunk)) return;
        const std::uint32_t first = total;
        total += size;
        reach = std::max(reach, of_chunk);
        order.pass_on(chunk);
        std::inclusive_scan(rows.length.begin(), rows.length.end(),
                            pairs.start.begin() + static_cast<std::ptrdiff_t>(begin + 1), std::plus<>(), first);
        if (first + size > room) return;
        std::copy_n(rows.parts.begin(), size, pairs.parts.begin() + first);
        if (pairs.is_far())
            std::copy_n(rows.index.begin(), size, pairs.index.begin() + first);
        else
            std::copy_n(rows.offset.begin(), size, pairs.offset.begin() + first);
    };
    workers.for_tasks(rows_of_threads.size(), [&](std::size_t thread) {
        try {
            for (std::size_t chunk = order.next(); chunk < chunks; chunk = order.next())
                write_chunk(chunk, rows_of_threads[thread]);
        } catch (...) {
            order.fail();
            throw;
        }
    });
    return reach;
}

/// All rows; a second time where there are more pairs than there was room for.
template <class Spline>
std::uint32_t find_self_pairs(const simd::Search& search, const Spline& kernel, const Workers& workers,
                              std::span<SelfRows> rows_of_threads, SelfPairs& pairs)
{
    const auto for_arrays = [&](auto&& change) {
        change(pairs.parts);
        if (pairs.is_far())
            change(pairs.index);
        else
            change(pairs.offset);
    };
    for (;;) {
        std::size_t room = std::numeric_limits<std::size_t>::max();
        for_arrays([&](const auto& values) {
            room = std::min(room, values.size() - std::min(values.size(), SelfPairs::kSlack));
        });
        const std::uint32_t reach = write_rows(search, kernel, room, workers, rows_of_threads, pairs);
        const std::size_t size = pairs.size();
        if (size <= room) {
            for_arrays([&](auto& values) {
                std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(size),
                            std::min(values.size(), SelfPairs::kSlack), 0);
            });
            return reach;
        }
        for_arrays([&](auto& values) { make_room(size + size / 32, SelfPairs::kSlack, values); });
    }
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
    rows_.resize(static_cast<std::size_t>(workers.threads()));
    pairs.unit = kernel.steepest() / SelfPairs::kParts;
    pairs.kernel_sum.resize(points.size());
    const auto find = [&] { return find_self_pairs(search, kernel, workers, rows_, pairs); };
    if (!pairs.is_far()) {
        if (find() <= kFarthest) return;
        pairs.offset = {};
        pairs.index.resize(1); // is_far()
    }
    // Not at the first step that would do with less: water that sloshes about the limit would be written twice.
    if (find() >= kFarthest / 4 * 3) return;
    pairs.index = {};
    find();
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
