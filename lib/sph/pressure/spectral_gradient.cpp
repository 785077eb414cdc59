#include "sph/pressure/complementarity_solver.hpp"

#include <algorithm>
#include <array>
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
    gradient_.resize(n);
    sums_.resize(Workers::chunk_count(n));
    const auto total = [&] {
        Sums sums;
        for (const Sums& part : sums_) sums += part;
        return sums;
    };
    const auto residual_of = [&](std::size_t i) {
        const Scalar part = residual_part(gradient_[i], x[i], diagonal[i]);
        return diagonal[i] > Scalar(0) ? part : Scalar(0);
    };
    const double pressed = workers.ordered_sum<double>(n, pressed_, [&](std::size_t i) {
        if (!(diagonal[i] > Scalar(0))) x[i] = 0; // a particle alone carries no pressure
        return x[i] > Scalar(0) ? 1.0 : 0.0;
    });
    const auto start = [&](std::size_t chunk, std::size_t begin, std::size_t end, std::span<const Scalar> product) {
        Sums sums;
        for (std::size_t i = begin; i < end; ++i) {
            gradient_[i] = product[i - begin] - b[i];
            sums.residual += static_cast<double>(residual_of(i));
        }
        sums_[chunk] = sums;
    };
    SolveResult result;
    if (pressed > 0.0) {
        op.apply(PressureSystem::GiveValues{x}, start);
        ++result.products;
    } else {
        workers.for_chunks(n, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            constexpr std::array<Scalar, Workers::kChunk> kZero{};
            start(chunk, begin, end, kZero);
        });
    }
    Sums sums = total();
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
        op.apply(
            [&](std::size_t begin, std::size_t end, std::span<Vec4> unknowns) {
                for (std::size_t i = begin; i < end; ++i) {
                    const Scalar to = std::max(Scalar(0), x[i] - factor * gradient_[i] / diagonal[i]);
                    unknowns[i][3] = diagonal[i] > Scalar(0) ? to - x[i] : Scalar(0);
                }
            },
            [&](std::size_t chunk, std::size_t begin, std::size_t end, std::span<const Scalar> product) {
                // What the compiler can take four or eight of at a time, and then the sums.
                std::array<Scalar, Workers::kChunk> step_gradient, gradient_sq, residual;
                for (std::size_t i = begin; i < end; ++i) {
                    const std::size_t k = i - begin;
                    const Scalar step = op.system().unknown(i), change = product[k];
                    const bool counts = (x[i] > Scalar(0)) | (step > Scalar(0)); // is or becomes free
                    const Scalar square = change * change / diagonal[i];
                    gradient_[i] += change;
                    x[i] = std::max(Scalar(0), x[i] + step);
                    step_gradient[k] = step * change;
                    gradient_sq[k] = counts ? square : Scalar(0);
                    residual[k] = residual_of(i);
                }
                Sums part;
                for (std::size_t k = 0; k < end - begin; ++k) {
                    part.step_gradient += static_cast<double>(step_gradient[k]);
                    part.gradient_sq += static_cast<double>(gradient_sq[k]);
                    part.residual += static_cast<double>(residual[k]);
                }
                sums_[chunk] = part;
            });
        ++result.products;
        sums = total();
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
