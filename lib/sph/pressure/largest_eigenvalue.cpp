#include "sph/pressure/largest_eigenvalue.hpp"

#include <cmath>

namespace flotsam {

double LargestEigenvalue::of(PressureOperator& op, std::span<const Scalar> diagonal)
{
    constexpr int kFirst = 6, kFurther = 2; // iterations
    const Workers& workers = op.system().workers();
    const std::size_t n = diagonal.size();
    const bool is_new = vector_.size() != n;
    if (is_new) {
        vector_.resize(n);
        for (std::size_t i = 0; i < n; ++i) vector_[i] = Scalar(1) + Scalar(0.5) * static_cast<Scalar>(i % 7);
    }
    scaled_.resize(n);
    product_.resize(n);
    const auto root = [&](std::size_t i) {
        return diagonal[i] > Scalar(0) ? Scalar(1) / std::sqrt(diagonal[i]) : Scalar(0);
    };
    const auto norm_of = [&](const std::vector<Scalar>& v) {
        return std::sqrt(workers.ordered_sum<double>(
            n, sums_, [&](std::size_t i) { return static_cast<double>(v[i]) * static_cast<double>(v[i]); }));
    };
    products_ = is_new ? kFirst : kFurther;
    double value = 0.0, length = norm_of(vector_);
    for (int k = 0; k < (is_new ? kFirst : kFurther); ++k) {
        workers.for_each(n, [&](std::size_t i) { scaled_[i] = vector_[i] * root(i); });
        op.apply(scaled_, product_);
        workers.for_each(n, [&](std::size_t i) { scaled_[i] = product_[i] * root(i); });
        const double product_length = norm_of(scaled_);
        value = product_length / length;
        if (!(value > 0.0)) { // no pair anywhere
            vector_.clear();
            return 1.0;
        }
        const Scalar inverse = static_cast<Scalar>(1.0 / product_length);
        workers.for_each(n, [&](std::size_t i) { vector_[i] = scaled_[i] * inverse; });
        length = 1.0;
    }
    return value;
}

} // namespace flotsam
