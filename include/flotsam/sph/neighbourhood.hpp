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

  private:
    /// Squared distances stand in place of the slopes.
    void find_distances(Scalar support, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
                        bool same, const Workers& workers, Pairs& pairs);
    template <class Spline>
    void find_with(const Spline& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> points,
                   bool same, std::span<const Scalar> weights, const Workers& workers, Pairs& pairs);
};

} // namespace flotsam
