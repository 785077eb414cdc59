#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/kernel.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// Pairs (i, j) closer than the support radius in compressed rows: those of i are start[i] .. start[i + 1].
struct Pairs {
    static constexpr std::size_t kSlack = 8; ///< entries behind the last pair, so that whole registers can be loaded

    std::vector<std::uint32_t> start; ///< rows + 1
    std::vector<std::uint32_t> index; ///< j of each pair
    std::vector<Scalar> slope;        ///< (dW/dr) / r of each pair: the gradient of W_ij at x_i is slope (x_i - x_j)
    std::vector<Scalar> kernel_sum;   ///< of each row: sum_j weight_j W_ij

    [[nodiscard]] std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
    [[nodiscard]] std::size_t size() const { return start.empty() ? 0 : start.back(); }
    /// Leaves `share` (0 to 1) of a pair's slope.
    void keep(std::size_t k, double share) { slope[k] *= static_cast<Scalar>(share); }
};

/// Pairs (i, j) of points of one set, in four bytes each: the difference of their numbers in 16 bits, which are enough
/// for points that are numbered by cells (up to some 10^4 points in a layer of cells), and the slope in 16 bits, too.
struct SelfPairs {
    static constexpr std::size_t kSlack = 8; ///< entries behind the last pair, so that whole registers can be loaded
    static constexpr float kParts = 65535;   ///< of the kernel's steepest slope, rounded to whole ones

    std::vector<std::uint32_t> start; ///< rows + 1
    std::vector<std::int16_t> offset; ///< j - i of each pair; empty if `index` is not
    std::vector<std::uint32_t> index; ///< j of each pair, where differences do not fit; else empty
    std::vector<std::uint16_t> parts; ///< of each pair: slope / unit
    Scalar unit = 0;                  ///< of the slopes: 1/65535 of the kernel's steepest, < 0
    std::vector<Scalar> kernel_sum;   ///< of each row: sum_j W_ij

    [[nodiscard]] std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
    [[nodiscard]] std::size_t size() const { return start.empty() ? 0 : start.back(); }
    [[nodiscard]] bool is_far() const { return !index.empty(); } ///< which of `offset` and `index` there is

    /// j of pair k of row i.
    [[nodiscard]] std::uint32_t neighbour(std::size_t i, std::size_t k) const
    {
        return is_far() ? index[k] : static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(i) + offset[k]);
    }
    /// (dW/dr) / r of pair k: the gradient of W_ij at x_i is slope (x_i - x_j).
    [[nodiscard]] Scalar slope(std::size_t k) const { return unit * static_cast<Scalar>(parts[k]); }
    /// Leaves `share` (0 to 1) of a pair's slope.
    void keep(std::size_t k, double share)
    {
        parts[k] = static_cast<std::uint16_t>(std::lround(share * static_cast<double>(parts[k])));
    }
};

/// Some rows of SelfPairs as a thread finds them, before it is known where they will stand: no pass to count them.
struct SelfRows {
    std::vector<std::uint32_t> length; ///< of each row
    std::vector<std::int16_t> offset;  ///< row after row, as in SelfPairs; so are the next two
    std::vector<std::uint32_t> index;
    std::vector<std::uint16_t> parts;
    std::vector<std::uint32_t> found; ///< neighbours of the row under way
    std::vector<Scalar> distance_sq;  ///< and their squared distances [m^2]
};

/// Neighbours of points among the points that `lists` has sorted into `grid`.
class NeighbourSearch {
  public:
    /// `same`: the points are those of the lists, and none is its own neighbour. `weights`: of the lists' points, by
    /// their index, for kernel_sum; empty: 1.
    template <class Kernel>
    void find(const Kernel& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
              bool same, std::span<const Scalar> weights, const Workers& workers, Pairs& pairs)
    {
        find_distances(kernel.support(), grid, lists, points, same, workers, pairs);
        workers.for_each(points.size(), [&](std::size_t i) {
            Scalar sum = 0;
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
                const Scalar r = std::sqrt(pairs.slope[k]);
                pairs.slope[k] = kernel.gradient_factor(r);
                sum += (weights.empty() ? Scalar(1) : weights[pairs.index[k]]) * kernel.value(r);
            }
            pairs.kernel_sum[i] = sum;
        });
    }
    void find(const QuinticSpline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
              bool same, std::span<const Scalar> weights, const Workers& workers, Pairs& pairs);
    void find(const CubicSpline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
              bool same, std::span<const Scalar> weights, const Workers& workers, Pairs& pairs);

    /// Neighbours of the lists' points among themselves.
    void find(const QuinticSpline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
              const Workers& workers, SelfPairs& pairs);
    void find(const CubicSpline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
              const Workers& workers, SelfPairs& pairs);

  private:
    /// Squared distances stand in place of the slopes.
    void find_distances(Scalar support, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
                        bool same, const Workers& workers, Pairs& pairs);
    template <class Spline>
    void find_with(const Spline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
                   bool same, std::span<const Scalar> weights, const Workers& workers, Pairs& pairs);
    template <class Spline>
    void find_among(const Spline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
                    const Workers& workers, SelfPairs& pairs);

    std::vector<SelfRows> rows_; ///< of each thread
};

} // namespace flotsam
