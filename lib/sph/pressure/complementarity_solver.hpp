#pragma once

#include "flotsam/sph/pressure/settings.hpp"
#include "sph/pressure/largest_eigenvalue.hpp"
#include "sph/pressure/pressure_system.hpp"

#include <algorithm>
#include <span>
#include <type_traits>
#include <vector>

namespace flotsam {

/// When a solve is done: mean over the particles of the complementarity residual times `scale` is at most `tolerance`.
struct SolveGoal {
    double scale = 1.0;
    double tolerance = 1e-3;
    int max_iterations = 200;
    int min_iterations = 1;
};

struct SolveResult {
    int iterations = 0;
    int products = 0;      ///< with A: what a solve costs; the eigenvalue's included
    double residual = 0.0; ///< in units of the goal's tolerance
    bool converged = false;
};

/// One particle's part of the residual below, g = A x - b.
template <class Real>
[[nodiscard]] Real residual_part(Real g, std::type_identity_t<Real> x, std::type_identity_t<Real> diagonal)
{
    return g < Real(0) ? -g : std::min(g, x * diagonal);
}

/// Mean of max(0, b - A x) where x = 0 and of min(|b - A x|, x diagonal) (|b - A x| where positive) where x > 0:
/// counts what is compressed and what is pushed too hard alike.
/// `product` is A x.
double complementarity_residual(std::span<const Scalar> x, std::span<const Scalar> b, std::span<const Scalar> product,
                                std::span<const Scalar> diagonal, const Workers& workers, std::vector<double>& scratch);

/// Solves 0 <= x _|_ A x - b >= 0, starting from the x that is passed in.
class ComplementaritySolver {
  public:
    virtual ~ComplementaritySolver() = default;
    virtual SolveResult solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                              const SolveGoal& goal, std::span<Scalar> x) = 0;
};

/// Relaxed Jacobi with projection. **Source:** Ihmsen et al. 2014, algorithm 1.
/// **Differs:** residual as above; the diagonal holds the rigid response; the relaxation is 1.5 / (largest eigenvalue
/// of D^-1 A) instead of 1/2, which is right for one kernel and one number of neighbours only.
class RelaxedJacobi final : public ComplementaritySolver {
  public:
    SolveResult solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                      const SolveGoal& goal, std::span<Scalar> x) override;

  private:
    LargestEigenvalue largest_eigenvalue_;
    std::vector<Scalar> product_;
    std::vector<double> sums_;
};

/// Modified proportioning with reduced gradient projections. Variables are scaled by the diagonal; on the free
/// particles the operator's preconditioner works, if it has one.
/// **Source:** Dostal & Schoeberl 2005, algorithm 1; Dostal, Domoradova & Sadowska 2011 for preconditioning in face.
class Mprgp final : public ComplementaritySolver {
  public:
    SolveResult solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                      const SolveGoal& goal, std::span<Scalar> x) override;

  private:
    struct Sums {
        double a = 0.0, b = 0.0, c = 0.0;
        Sums& operator+=(const Sums& other);
    };
    double largest_feasible_step(std::span<const Scalar> x, const Workers& workers);
    void advance(double step, std::span<Scalar> x, const Workers& workers);

    LargestEigenvalue largest_eigenvalue_;
    std::vector<Scalar> root_, gradient_, preconditioned_, direction_, product_, work_;
    std::vector<double> sums_;
    std::vector<Sums> pair_sums_;
};

/// Projected gradient whose step length is the inverse curvature that the last step met. With s the last step of x and
/// y = A s its change of the gradient g,
///
///     x <- max(0, x - t D^-1 g),   t = s . y / y . D^-1 y   (over the particles that are or become free)
///
/// One product with A an iteration, whatever the bounds do: where the free surface moves, a conjugate gradient method
/// stops at the first particle that loses its pressure, and pays two. The residual may rise on the way; if it finds no
/// new minimum for long, MPRGP goes on.
/// **Source:** Barzilai & Borwein 1988, the second of their lengths; Birgin, Martinez & Raydan 2000 for the projection.
/// **Differs:** no line search (Dai & Fletcher 2005 show that it may then cycle: hence MPRGP).
class SpectralGradient final : public ComplementaritySolver {
  public:
    SolveResult solve(PressureOperator& op, std::span<const Scalar> b, std::span<const Scalar> diagonal,
                      const SolveGoal& goal, std::span<Scalar> x) override;

  private:
    struct Sums {
        double step_gradient = 0.0; ///< s . y
        double gradient_sq = 0.0;   ///< y . D^-1 y
        double residual = 0.0;
        Sums& operator+=(const Sums& other);
    };
    LargestEigenvalue largest_eigenvalue_;
    double largest_curvature_ = 0.0; ///< of D^-1 A, met lately; 0: none yet
    std::vector<Scalar> gradient_;
    std::vector<double> pressed_;
    std::vector<Sums> sums_;
    Mprgp fallback_;
};

} // namespace flotsam
