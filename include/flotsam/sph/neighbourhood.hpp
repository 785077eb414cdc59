#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/cell_grid.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// Pairs (i, j) closer than the support radius in compressed rows: those of i are start[i] .. start[i + 1].
struct Pairs {
    std::vector<std::uint32_t> start; ///< rows + 1
    std::vector<std::uint32_t> index; ///< j of each pair
    std::vector<Vec4> gradient;       ///< x, y, z: gradient of W_ij with respect to x_i; w: W_ij

    [[nodiscard]] std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
    [[nodiscard]] std::size_t size() const { return index.size(); }
};

/// Neighbours of points `a` among points `b` (which `lists` has sorted into `grid`). A point is not its own neighbour:
/// pass `same = true` if a and b are one set. Scratch is kept between calls.
class NeighbourSearch {
  public:
    template <class Kernel>
    void find(const Kernel& kernel, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> a,
              std::span<const Vec4> b, bool same, const Workers& workers, Pairs& pairs)
    {
        find_indices(static_cast<Scalar>(kernel.support()), grid, lists, a, b, same, workers, pairs);
        pairs.gradient.resize(pairs.index.size());
        workers.for_each(a.size(), [&](std::size_t i) {
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
                Vec4 offset = a[i] - b[pairs.index[k]];
                offset[3] = 0;
                const Scalar r = offset.norm();
                Vec4 gradient = kernel.gradient_factor(r) * offset;
                gradient[3] = kernel.value(r);
                pairs.gradient[k] = gradient;
            }
        });
    }

  private:
    void find_indices(Scalar support, const CellGrid& grid, const CellLists& lists, std::span<const Vec4> a,
                      std::span<const Vec4> b, bool same, const Workers& workers, Pairs& pairs);

    std::vector<std::vector<std::uint32_t>> found_; ///< per chunk, rows one after another
};

} // namespace flotsam
