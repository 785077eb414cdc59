#include "sph/pressure/complementarity_solver.hpp"

#include <algorithm>
#include <limits>

namespace flotsam {

SpectralGradient::Sums& SpectralGradient::Sums::operator+=(const Sums& other)
{
    step_gradient += other.step_gradient;
    gradient_sq += other.gradient_sq;
    residual += other.residual;
    return *this;
}

// g = A x - b is kept by g += A s with the step s that x takes: the product of a small step has small rounding errors.

SolveResult SpectralGradient::solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                                    const SolveGoal& goal, std::span<Scalar> x)
{
    constexpr int kPatience = 50;        // iterations without a new least residual
    constexpr double kForgetting = 0.98; // of the largest curvature, an iteration
    const Workers& workers = op.system().workers();
    const std::size_t n = x.size();
    for (auto* v : {&gradient_, &step_, &product_}) v->resize(n);
    const double pressed = workers.ordered_sum<double>(n, pressed_, [&](std::size_t i) {
        if (!(diagonal[i] > Scalar(0))) x[i] = 0; // a particle alone carries no pressure
        return x[i] > Scalar(0) ? 1.0 : 0.0;
    });
    const auto residual_of = [&](std::size_t i) {
        return diagonal[i] > Scalar(0) ? residual_part(gradient_[i], x[i], diagonal[i]) : 0.0;
    };
    SolveResult result;
    if (pressed > 0.0) {
        op.apply(x, product_);
        ++result.products;
    } else {
        std::fill(product_.begin(), product_.end(), Scalar(0));
    }
    Sums sums = workers.ordered_sum<Sums>(n, sums_, [&](std::size_t i) {
        gradient_[i] = product_[i] - b[i];
        return Sums{0.0, 0.0, residual_of(i)};
    });
    double length = 0.0; // of the step along -D^-1 g; not known yet
    double least = std::numeric_limits<double>::infinity();
    for (int since_least = 0; since_least < kPatience; ++result.iterations) {
        result.residual = n == 0 ? 0.0 : goal.scale * sums.residual / static_cast<double>(n);
        result.converged = result.residual <= goal.tolerance;
        if (result.converged && result.iterations >= goal.min_iterations) return result;
        if (result.iterations >= goal.max_iterations) return result;
        since_least = result.residual < least ? 0 : since_least + 1;
        least = std::min(least, result.residual);
        if (length == 0.0) {
            if (largest_curvature_ == 0.0) {
                largest_curvature_ = largest_eigenvalue_.of(op, diagonal);
                result.products += largest_eigenvalue_.products();
            }
            length = 1.0 / largest_curvature_;
        }
        const Scalar factor = static_cast<Scalar>(length);
        workers.for_each(n, [&](std::size_t i) {
            step_[i] = diagonal[i] > Scalar(0) ? std::max(Scalar(0), x[i] - factor * gradient_[i] / diagonal[i]) - x[i]
                                               : Scalar(0);
        });
        op.apply(step_, product_);
        ++result.products;
        sums = workers.ordered_sum<Sums>(n, sums_, [&](std::size_t i) {
            const double change = product_[i];
            const bool counts = x[i] > Scalar(0) || step_[i] > Scalar(0); // is or becomes free
            gradient_[i] += product_[i];
            x[i] = std::max(Scalar(0), x[i] + step_[i]);
            return Sums{static_cast<double>(step_[i]) * change,
                        counts ? change * change / static_cast<double>(diagonal[i]) : 0.0, residual_of(i)};
        });
        const bool has_curvature = sums.step_gradient > 0.0 && sums.gradient_sq > 0.0;
        length = has_curvature ? sums.step_gradient / sums.gradient_sq : 0.0;
        if (has_curvature) largest_curvature_ = std::max(kForgetting * largest_curvature_, 1.0 / length);
    }
    SolveGoal rest = goal;
    rest.max_iterations -= result.iterations;
    const SolveResult last = fallback_.solve(op, b, diagonal, rest, x);
    return {result.iterations + last.iterations, result.products + last.products, last.residual, last.converged};
}

} // namespace flotsam
