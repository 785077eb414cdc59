#pragma once

#include "flotsam/core/types.hpp"
#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <cstdint>
#include <span>

/// What the neighbour search does for the rows [begin, end) of the pairs, on one thread; as sph/simd/pair_sums.hpp.
namespace flotsam::simd {

/// Candidates and the point set that looks for neighbours among them.
struct Search {
    const CellGrid* grid = nullptr;
    const CellLists* lists = nullptr;
    std::span<const Vec4> points;
    bool same = false; ///< the points are the candidates, in the order of the lists' indices
    Scalar support = 0;
};

/// counts[i - begin]: neighbours of point i.
void count_neighbours(const Search& search, std::size_t begin, std::size_t end, std::uint32_t* counts);

/// Writes the neighbours of the rows, pairs.start being known, and their squared distances in place of the slopes.
void write_neighbours(const Search& search, std::size_t begin, std::size_t end, Pairs& pairs);

/// Squared distances in pairs.slope become slopes, and pairs.kernel_sum is written: sum_j weight_j W_ij; no weights: 1.
void evaluate_kernel(const QuinticSpline& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                     Pairs& pairs);
void evaluate_kernel(const CubicSpline& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                     Pairs& pairs);

/// Finds the rows, into `rows` instead of `pairs` (whose unit and is_far() are given; its kernel_sum is written);
/// returns the largest |j - i|: differences above 2^15 - 1 have not been written right.
std::uint32_t find_self_rows(const Search& search, const QuinticSpline& kernel, std::size_t begin, std::size_t end,
                             SelfRows& rows, SelfPairs& pairs);
std::uint32_t find_self_rows(const Search& search, const CubicSpline& kernel, std::size_t begin, std::size_t end,
                             SelfRows& rows, SelfPairs& pairs);

} // namespace flotsam::simd
