#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <span>

namespace flotsam {

/// rho_i = m (W(0) + sum_j W_ij) + rho0 sum_b V_b W_ib.
///
/// **Source:** Akinci et al. 2012, eq. 6. `fluid_sums` and `boundary_sums` are the kernel sums of the pairs, one per
/// fluid particle, the latter with V_b [m^3] as weights; `density` [kg/m^3] is written.
void compute_density(std::span<const Scalar> fluid_sums, std::span<const Scalar> boundary_sums, Scalar kernel_at_zero,
                     double particle_mass, double rest_density, const Workers& workers, std::span<Scalar> density);

/// p = k (rho - rho0) [Pa]: the linear equation of state. **Source:** Mueller et al. 2003, eq. 12.
[[nodiscard]] constexpr double linear_equation_of_state(double density, double rest_density, double stiffness)
{
    return stiffness * (density - rest_density);
}

} // namespace flotsam
