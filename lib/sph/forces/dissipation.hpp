#pragma once

#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Dissipation of what the particles cannot resolve: velocity differences between neighbours that are not part of a
/// locally linear velocity field. A particle fluid without it keeps the noise of its own rearrangement for ever.
///
///     a_i = 2 (dim + 2) sum_j (m / rho_ij) nu_ij q_ij / (|x_ij|^2 + 0.01 h^2) grad W_ij,   nu_ij = strength d |q_ij| / |x_ij|
///     q_ij = (v_ij - (G_i + G_j) x_ij / 2) . x_ij, limited to lie between 0 and v_ij . x_ij;   G_i the velocity gradient at i
///
/// Quadratic in the difference, so it has no speed of its own and vanishes with the noise; zero for any linear flow (shear,
/// rotation, strain). Linear and angular momentum are kept and energy never rises. Between fluid particles only.
/// **Source:** von Neumann & Richtmyer 1950 for the quadratic form; Frontiere, Raskin & Owen 2017 for taking the linear
/// field away. **Differs:** G is renormalised (Randles & Libersky 1996); the limiter is the interval above.
class Dissipation {
  public:
    /// Adds dt a_i to `velocity`; reads the state's velocities.
    void add(double strength, double dt, int dimensions, double spacing, const FluidState& fluid, const Pairs& pairs,
             const Workers& workers, std::span<Vec4> velocity);

  private:
    void velocity_gradients(int dimensions, const FluidState& fluid, const Pairs& pairs, const Workers& workers);

    std::vector<Eigen::Matrix<Scalar, 3, 3>> gradient_;
};

} // namespace flotsam
