#include "sph/pressure/complementarity_solver.hpp"
#include "sph/pressure/response_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flotsam {
Mprgp::Sums& Mprgp::Sums::operator+=(const Sums& other)
{
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
}

// Symbols as in the paper: g gradient, phi free gradient (g where x > 0), beta chopped gradient (min(g, 0) where
// x = 0), phi~ = min(x / alpha, phi), z preconditioned phi, p direction. All of them in the variable y = sqrt(diagonal)
// x, A scaled likewise.

SolveResult Mprgp::solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                         const SolveGoal& goal, std::span<Scalar> x)
{
    const Workers& workers = op.system().workers();
    const std::size_t n = x.size();
    for (auto* v : {&root_, &gradient_, &preconditioned_, &direction_, &product_, &work_}) v->resize(n);
    workers.for_each(n, [&](std::size_t i) {
        root_[i] = diagonal[i] > Scalar(0) ? Scalar(1) / std::sqrt(diagonal[i]) : Scalar(0); // 0 freezes lone particles
        if (!(diagonal[i] > Scalar(0))) x[i] = 0;
    });
    double norm = 0.0, alpha = 0.0; // of A, and the length of projected steps; not known yet
    // y is kept as x: x = y * root. gradient_ = root * (A x - b).
    SolveResult result;
    const auto refresh_gradient = [&] {
        op.apply(x, product_);
        ++result.products;
        workers.for_each(n, [&](std::size_t i) { gradient_[i] = root_[i] * (product_[i] - b[i]); });
    };
    const auto free_gradient = [&](std::size_t i) { return x[i] > Scalar(0) ? gradient_[i] : Scalar(0); };
    const auto y_of = [&](std::size_t i) { return root_[i] > Scalar(0) ? x[i] / root_[i] : Scalar(0); };
    const auto residual = [&] {
        const double sum = workers.ordered_sum<double>(n, sums_, [&](std::size_t i) {
            if (!(root_[i] > Scalar(0))) return 0.0;
            return residual_part(static_cast<double>(gradient_[i]) / static_cast<double>(root_[i]), x[i], diagonal[i]);
        });
        return n == 0 ? 0.0 : goal.scale * sum / static_cast<double>(n);
    };
    const auto precondition = [&] {
        if (op.preconditioner() == nullptr) {
            workers.for_each(n, [&](std::size_t i) { preconditioned_[i] = free_gradient(i); });
            return;
        }
        workers.for_each(n,
                         [&](std::size_t i) { work_[i] = root_[i] > Scalar(0) ? gradient_[i] / root_[i] : Scalar(0); });
        op.preconditioner()->apply(x, work_, preconditioned_);
        workers.for_each(n, [&](std::size_t i) {
            preconditioned_[i] = root_[i] > Scalar(0) ? preconditioned_[i] / root_[i] : Scalar(0);
        });
    };
    const auto restart_direction = [&] {
        precondition();
        direction_.assign(preconditioned_.begin(), preconditioned_.end());
    };

    std::vector<Sums>& sums = pair_sums_;
    refresh_gradient();
    restart_direction();
    while (true) {
        result.residual = residual();
        result.converged = result.residual <= goal.tolerance;
        if (result.converged && result.iterations >= goal.min_iterations) break;
        if (result.iterations >= goal.max_iterations) break;
        if (result.iterations == 0) {
            norm = largest_eigenvalue_.of(op, diagonal);
            result.products += largest_eigenvalue_.products();
        }
        alpha = 1.5 / norm; // leaves room for a norm that is underestimated (a bound of 2 is allowed)
        ++result.iterations;
        const Sums norms = workers.ordered_sum<Sums>(n, sums, [&](std::size_t i) {
            const double g = gradient_[i];
            const double phi = free_gradient(i);
            const double reduced = std::min(static_cast<double>(y_of(i)) / alpha, phi);
            const double beta = x[i] > Scalar(0) ? 0.0 : std::min(g, 0.0);
            return Sums{beta * beta, reduced * phi, 0.0};
        });
        const bool proportional = norms.a <= norms.b;
        if (!proportional) {
            workers.for_each(n, [&](std::size_t i) {
                direction_[i] = x[i] > Scalar(0) ? Scalar(0) : std::min(gradient_[i], Scalar(0));
            });
        }
        workers.for_each(n, [&](std::size_t i) { work_[i] = root_[i] * direction_[i]; });
        op.apply(work_, product_);
        ++result.products;
        const Sums products = workers.ordered_sum<Sums>(n, sums, [&](std::size_t i) {
            const double p = direction_[i];
            return Sums{gradient_[i] * p, p * static_cast<double>(root_[i]) * static_cast<double>(product_[i]), p * p};
        });
        if (products.c > 0.0) norm = std::max(norm, products.b / products.c); // never too small for long
        if (!(products.b > 0.0)) { // no curvature left along it within rounding
            refresh_gradient();
            restart_direction();
            continue;
        }
        const double step = products.a / products.b;
        if (!proportional) {
            advance(step, x, workers);
            restart_direction();
            continue;
        }
        const double feasible = largest_feasible_step(x, workers);
        if (step <= feasible) {
            advance(step, x, workers);
            precondition();
            const Sums next = workers.ordered_sum<Sums>(n, sums, [&](std::size_t i) {
                return Sums{static_cast<double>(preconditioned_[i]) * static_cast<double>(root_[i]) *
                                static_cast<double>(product_[i]),
                            0.0, 0.0};
            });
            const Scalar gamma = static_cast<Scalar>(next.a / products.b);
            workers.for_each(n, [&](std::size_t i) { direction_[i] = preconditioned_[i] - gamma * direction_[i]; });
        } else {
            advance(feasible, x, workers);
            workers.for_each(n, [&](std::size_t i) {
                x[i] = std::max(Scalar(0), x[i] - static_cast<Scalar>(alpha) * root_[i] * free_gradient(i));
            });
            refresh_gradient();
            restart_direction();
        }
    }
    return result;
}

void Mprgp::advance(double step, std::span<Scalar> x, const Workers& workers)
{
    const Scalar s = static_cast<Scalar>(step);
    workers.for_each(x.size(), [&](std::size_t i) {
        x[i] = std::max(Scalar(0), x[i] - s * root_[i] * direction_[i]);
        gradient_[i] -= s * root_[i] * product_[i];
    });
}

double Mprgp::largest_feasible_step(std::span<const Scalar> x, const Workers& workers)
{
    const std::size_t n = x.size();
    sums_.assign(Workers::chunk_count(n), std::numeric_limits<double>::infinity());
    workers.for_chunks(n, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = begin; i < end; ++i) {
            const double change = static_cast<double>(root_[i]) * static_cast<double>(direction_[i]);
            if (change > 0.0) least = std::min(least, static_cast<double>(x[i]) / change);
        }
        sums_[chunk] = least;
    });
    return sums_.empty() ? 0.0 : *std::min_element(sums_.begin(), sums_.end());
}

} // namespace flotsam
