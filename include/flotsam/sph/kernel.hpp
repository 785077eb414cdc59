#pragma once

#include "flotsam/core/types.hpp"

#include <cmath>
#include <numbers>

namespace flotsam {

/// Cubic spline with support radius h.
///
///     W(r) = s (6 (q^3 - q^2) + 1)  for q = r/h <= 1/2,   2 s (1 - q)^3  for q <= 1,   0 beyond
///     s = 8 / (pi h^3) in 3-D, 40 / (7 pi h^2) in 2-D
///
/// **Source:** Monaghan 1992; in this form Koschier et al. 2019, eq. 4.
class CubicSpline {
  public:
    /// `support` [m], > 0; `dimensions` 2 or 3.
    CubicSpline(double support, int dimensions)
        : support_(static_cast<Scalar>(support)), inv_support_(static_cast<Scalar>(1.0 / support)),
          peak_(static_cast<Scalar>(dimensions == 3 ? 8.0 / (std::numbers::pi * support * support * support)
                                                    : 40.0 / (7.0 * std::numbers::pi * support * support))),
          slope_(static_cast<Scalar>(static_cast<double>(peak_) / (support * support)))
    {
    }

    [[nodiscard]] Scalar support() const { return support_; }

    /// W(r) [1/m^dimensions].
    [[nodiscard]] Scalar value(Scalar r) const
    {
        const Scalar q = r * inv_support_;
        const Scalar rest = std::max(Scalar(0), Scalar(1) - q);
        const Scalar inner = Scalar(6) * q * q * (q - Scalar(1)) + Scalar(1);
        const Scalar outer = Scalar(2) * rest * rest * rest;
        return peak_ * (q <= Scalar(0.5) ? inner : outer);
    }

    /// (dW/dr) / r, so that grad W = factor * (x_i - x_j); 0 at r = 0 by symmetry of its use.
    [[nodiscard]] Scalar gradient_factor(Scalar r) const
    {
        const Scalar q = r * inv_support_;
        const Scalar rest = std::max(Scalar(0), Scalar(1) - q);
        const Scalar inner = Scalar(18) * q - Scalar(12);
        const Scalar outer = Scalar(-6) * rest * rest / std::max(q, Scalar(1e-6));
        return slope_ * (q <= Scalar(0.5) ? inner : outer);
    }

  private:
    Scalar support_, inv_support_, peak_, slope_;
};

/// Poly6 kernel of two dimensions, W(r) = 4 / (pi h^2) (1 - r^2/h^2)^3.
///
/// **Source:** Mueller et al. 2003. Here for worked examples of density sums; the solver uses the spline.
class Poly6Kernel2d {
  public:
    explicit Poly6Kernel2d(double support) : support_(static_cast<Scalar>(support)) {}

    [[nodiscard]] Scalar support() const { return support_; }
    [[nodiscard]] Scalar value(Scalar r) const
    {
        const Scalar rest = std::max(Scalar(0), Scalar(1) - r * r / (support_ * support_));
        return peak() * rest * rest * rest;
    }
    [[nodiscard]] Scalar gradient_factor(Scalar r) const
    {
        const Scalar rest = std::max(Scalar(0), Scalar(1) - r * r / (support_ * support_));
        return Scalar(-6) * peak() * rest * rest / (support_ * support_);
    }

  private:
    [[nodiscard]] Scalar peak() const { return Scalar(4) / (std::numbers::pi_v<Scalar> * support_ * support_); }
    Scalar support_;
};

} // namespace flotsam
