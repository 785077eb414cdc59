#include "flotsam/sph/neighbourhood.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>

namespace flotsam {
namespace {

/// Calls visit(first, last) for the ranges of lists.order that hold the points of the 3 x 3 x 3 cells around p; the
/// three cells of a row along x are one range.
template <class Visit>
void for_candidate_ranges(const CellGrid& grid, const CellLists& lists, const Vec4& p, Visit&& visit)
{
    const Eigen::Vector3i home = grid.cell_of(p);
    const Eigen::Vector3i low = (home.array() - 1).max(0);
    const Eigen::Vector3i high = (home.array() + 1).min(grid.cells.array() - 1);
    for (int z = low.z(); z <= high.z(); ++z) {
        for (int y = low.y(); y <= high.y(); ++y) {
            visit(lists.start[grid.index_of({low.x(), y, z})], lists.start[grid.index_of({high.x(), y, z}) + 1]);
        }
    }
}

} // namespace

void NeighbourSearch::find_indices(Scalar support, const CellGrid& grid, const CellLists& lists,
                                   std::span<const Vec4> a, std::span<const Vec4> b, bool same, const Workers& workers,
                                   Pairs& pairs)
{
    FLOTSAM_ASSERT(grid.inv_cell * support <= Scalar(1.001), "a cell must be at least one support radius wide");
    const Scalar support_sq = support * support;
    found_.resize(std::max(found_.size(), Workers::chunk_count(a.size())));
    counts_.resize(found_.size());
    pairs.start.resize(a.size() + 1);
    pairs.start[0] = 0;
    workers.for_chunks(a.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t>& found = found_[chunk];
        if (found.empty()) found.resize(Workers::kChunk * 192);
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t before = count;
            const Vec4 own = a[i];
            for_candidate_ranges(grid, lists, own, [&](std::uint32_t first, std::uint32_t last) {
                if (found.size() < count + (last - first)) found.resize(2 * (count + (last - first)));
                std::uint32_t* const out = found.data();
                // Every candidate is written and kept by counting it: its distance is a coin toss to a branch.
                for (std::uint32_t k = first; k < last; ++k) {
                    const std::uint32_t j = lists.order[k];
                    out[count] = j;
                    count += static_cast<std::size_t>((own - b[j]).squaredNorm() < support_sq) &
                             static_cast<std::size_t>(!same || j != i);
                }
            });
            pairs.start[i + 1] = static_cast<std::uint32_t>(count - before);
        }
        counts_[chunk] = count;
    });
    for (std::size_t i = 0; i < a.size(); ++i) pairs.start[i + 1] += pairs.start[i];
    const std::size_t total = pairs.start[a.size()];
    // Twice as many, so that spreading water soon needs no more; pages that are never written cost no memory.
    if (pairs.index.capacity() < total) pairs.index.reserve(2 * total);
    if (pairs.gradient.capacity() < total) pairs.gradient.reserve(2 * total);
    pairs.index.resize(total);
    workers.for_chunks(a.size(), [&](std::size_t chunk, std::size_t begin, std::size_t) {
        std::copy_n(found_[chunk].begin(), counts_[chunk], pairs.index.begin() + pairs.start[begin]);
    });
}

} // namespace flotsam
