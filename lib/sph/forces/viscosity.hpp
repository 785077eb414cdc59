#pragma once

#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Physical viscosity between particles, and between particles and boundary samples:
///
///     a_i = 2 (dim + 2) nu sum_j (m_j / rho_j) (v_ij . x_ij) / (|x_ij|^2 + 0.01 h^2) grad W_ij
///
/// Forces lie along x_ij, so linear and angular momentum are kept; a sample counts as m = rho0 V_b, rho = rho0, and
/// takes the reaction. **Source:** Monaghan 2005; in this form Koschier et al. 2019, eq. 23.
class Viscosity {
  public:
    /// Adds dt a_i to `velocity` (a copy of the state's velocities is read, so the order of particles does not matter)
    /// and the reaction impulses to `owner_impulses` (about `centers`) [N s].
    void add(double kinematic_viscosity, double dt, int dimensions, double support, const FluidState& fluid,
             const BoundaryState& boundary, const Pairs& fluid_pairs, const Pairs& boundary_pairs,
             std::span<const Vec3d> centers, const Workers& workers, std::span<Vec4> velocity,
             std::span<Wrench> owner_impulses);

  private:
    struct Reaction {
        std::int32_t owner;
        Wrench impulse;
    };
    std::vector<std::vector<Reaction>> reactions_; ///< per chunk
};

} // namespace flotsam
