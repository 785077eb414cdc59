#include "flotsam/sph/density.hpp"

namespace flotsam {

void compute_density(const Pairs& fluid_pairs, const Pairs& boundary_pairs, Scalar kernel_at_zero, double particle_mass,
                     double rest_density, const Workers& workers, std::span<Scalar> density)
{
    const Scalar mass = static_cast<Scalar>(particle_mass);
    const Scalar rho0 = static_cast<Scalar>(rest_density);
    workers.for_each(density.size(), [&](std::size_t i) {
        density[i] = mass * (kernel_at_zero + fluid_pairs.kernel_sum[i]) + rho0 * boundary_pairs.kernel_sum[i];
    });
}

} // namespace flotsam
