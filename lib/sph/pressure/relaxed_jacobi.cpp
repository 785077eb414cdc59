#include "sph/pressure/complementarity_solver.hpp"

#include <algorithm>

namespace flotsam {

SolveResult RelaxedJacobi::solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                                 const SolveGoal& goal, std::span<Scalar> x)
{
    const Workers& workers = op.system().workers();
    product_.resize(x.size());
    Scalar relaxation = 0; // not known yet
    SolveResult result;
    op.apply(x, product_);
    ++result.products;
    while (true) {
        result.residual = goal.scale * complementarity_residual(x, b, product_, diagonal, workers, sums_);
        result.converged = result.residual <= goal.tolerance;
        if (result.converged && result.iterations >= goal.min_iterations) break;
        if (result.iterations >= goal.max_iterations) break;
        // Beyond 2 / (largest eigenvalue) it diverges; the eigenvalue is underestimated.
        if (result.iterations == 0) {
            relaxation = static_cast<Scalar>(1.5 / largest_eigenvalue_.of(op, diagonal));
            result.products += largest_eigenvalue_.products();
        }
        workers.for_each(x.size(), [&](std::size_t i) {
            if (!(diagonal[i] > Scalar(0))) return; // a particle alone carries no pressure
            x[i] = std::max(Scalar(0), x[i] + relaxation * (b[i] - product_[i]) / diagonal[i]);
        });
        ++result.iterations;
        op.apply(x, product_);
        ++result.products;
    }
    return result;
}

} // namespace flotsam
