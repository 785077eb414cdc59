#pragma once

#include "flotsam/core/types.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

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
    [[nodiscard]] Scalar peak() const { return peak_; } ///< s

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
    [[nodiscard]] Scalar steepest() const { return Scalar(-12) * slope_; } ///< gradient_factor at r = 0, the lowest

  private:
    Scalar support_, inv_support_, peak_, slope_;
};

/// Quintic spline with support radius h.
///
///     W(r) = s ((3 - t)^5 - 6 (2 - t)^5 + 15 (1 - t)^5),  t = 3 r / h, each power where its base is positive
///     s = 1 / (120 pi) (3 / h)^3 in 3-D, 7 / (478 pi) (3 / h)^2 in 2-D
///
/// **Source:** Morris, Fox & Zhu 1997, eq. 29 (Schoenberg's M6).
class QuinticSpline {
  public:
    /// `support` [m], > 0; `dimensions` 2 or 3.
    QuinticSpline(double support, int dimensions)
        : support_(static_cast<Scalar>(support)), scale_(static_cast<Scalar>(3.0 / support)),
          factor_(static_cast<Scalar>(dimensions == 3 ? std::pow(3.0 / support, 3) / (120.0 * std::numbers::pi)
                                                      : 7.0 * std::pow(3.0 / support, 2) / (478.0 * std::numbers::pi)))
    {
    }

    [[nodiscard]] Scalar support() const { return support_; }
    [[nodiscard]] Scalar scale() const { return scale_; }   ///< 3 / h
    [[nodiscard]] Scalar factor() const { return factor_; } ///< s

    /// W(r) [1/m^dimensions].
    [[nodiscard]] Scalar value(Scalar r) const
    {
        const Scalar t = r * scale_;
        const Scalar a = above(3, t), b = above(2, t), c = above(1, t);
        return factor_ * (pow4(a) * a - Scalar(6) * pow4(b) * b + Scalar(15) * pow4(c) * c);
    }

    /// (dW/dr) / r, so that grad W = factor * (x_i - x_j); finite at r = 0, where it is not used.
    [[nodiscard]] Scalar gradient_factor(Scalar r) const
    {
        const Scalar t = std::max(r * scale_, Scalar(1e-4)); // below, the three terms cancel to rounding
        const Scalar slope = pow4(above(3, t)) - Scalar(6) * pow4(above(2, t)) + Scalar(15) * pow4(above(1, t));
        return Scalar(-5) * factor_ * scale_ * scale_ * slope / t;
    }
    /// gradient_factor's limit at r = 0, the lowest.
    [[nodiscard]] Scalar steepest() const { return Scalar(-120) * factor_ * scale_ * scale_; }

  private:
    static Scalar above(int knot, Scalar t) { return std::max(Scalar(0), static_cast<Scalar>(knot) - t); }
    static Scalar pow4(Scalar x) { return (x * x) * (x * x); }

    Scalar support_, scale_, factor_;
};

/// Which kernel, and with it how many neighbours a particle has. Particles at rest are a packing that holds shear up to
/// a part of its pressure, like a very weak granular material; a smoother and wider kernel makes that part smaller.
enum class KernelKind {
    quintic, ///< support of 2.7 spacings: 82 neighbours in 3-D
    cubic    ///< support of 2 spacings: 33 neighbours in 3-D; faster, with two to three times the strength at rest
};

/// The kernel that a KernelKind names, for a particle spacing.
class Kernel {
  public:
    /// `spacing` d [m], > 0; `dimensions` 2 or 3.
    Kernel(KernelKind kind, double spacing, int dimensions) : kernel_(make(kind, spacing, dimensions)) {}

    /// Support radius h in spacings.
    [[nodiscard]] static constexpr double support_in_spacings(KernelKind kind)
    {
        return kind == KernelKind::cubic ? 2.0 : 2.7;
    }
    /// Calls `use` with the kernel itself, for loops over pairs.
    template <class Use>
    decltype(auto) visit(Use&& use) const
    {
        return std::visit(std::forward<Use>(use), kernel_);
    }
    [[nodiscard]] Scalar support() const
    {
        return visit([](const auto& kernel) { return kernel.support(); });
    }
    [[nodiscard]] Scalar value(Scalar r) const
    {
        return visit([r](const auto& kernel) { return kernel.value(r); });
    }

  private:
    using Any = std::variant<QuinticSpline, CubicSpline>;
    static Any make(KernelKind kind, double spacing, int dimensions)
    {
        const double support = support_in_spacings(kind) * spacing;
        if (kind == KernelKind::cubic) return CubicSpline(support, dimensions);
        return QuinticSpline(support, dimensions);
    }

    Any kernel_;
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
