#include "sph/pressure/complementarity_solver.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {

double complementarity_residual(std::span<const Scalar> x, std::span<const Scalar> b, std::span<const Scalar> product,
                                std::span<const Scalar> diagonal, const Workers& workers, std::vector<double>& scratch)
{
    if (x.empty()) return 0.0;
    const double sum = workers.ordered_sum<double>(x.size(), scratch, [&](std::size_t i) {
        const double rest = static_cast<double>(b[i]) - static_cast<double>(product[i]);
        return rest > 0.0 ? rest : std::min(-rest, static_cast<double>(x[i]) * static_cast<double>(diagonal[i]));
    });
    return sum / static_cast<double>(x.size());
}

} // namespace flotsam
