#include "sph/pressure/complementarity_solver.hpp"

namespace flotsam {

double complementarity_residual(std::span<const Scalar> x, std::span<const Scalar> b, std::span<const Scalar> product,
                                std::span<const Scalar> diagonal, const Workers& workers, std::vector<double>& scratch)
{
    if (x.empty()) return 0.0;
    const double sum = workers.ordered_sum<double>(x.size(), scratch, [&](std::size_t i) {
        return residual_part(static_cast<double>(product[i]) - static_cast<double>(b[i]), x[i], diagonal[i]);
    });
    return sum / static_cast<double>(x.size());
}

} // namespace flotsam
