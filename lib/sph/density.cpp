#include "flotsam/sph/density.hpp"

namespace flotsam {

void compute_density(std::span<const Scalar> fluid_sums, std::span<const Scalar> boundary_sums, Scalar kernel_at_zero,
                     double particle_mass, double rest_density, const Workers& workers, std::span<Scalar> density)
{
    const Scalar mass = static_cast<Scalar>(particle_mass);
    const Scalar rho0 = static_cast<Scalar>(rest_density);
    workers.for_each(density.size(), [&](std::size_t i) {
        density[i] = mass * (kernel_at_zero + fluid_sums[i]) + rho0 * boundary_sums[i];
    });
}

} // namespace flotsam
