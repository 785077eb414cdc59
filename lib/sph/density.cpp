#include "flotsam/sph/density.hpp"

namespace flotsam {

void compute_density(const Pairs& fluid_pairs, const Pairs& boundary_pairs, std::span<const Vec4> boundary,
                     Scalar kernel_at_zero, double particle_mass, double rest_density, const Workers& workers,
                     std::span<Scalar> density)
{
    const Scalar mass = static_cast<Scalar>(particle_mass);
    const Scalar rho0 = static_cast<Scalar>(rest_density);
    workers.for_each(density.size(), [&](std::size_t i) {
        Scalar water = kernel_at_zero;
        for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k) {
            water += fluid_pairs.gradient[k][3];
        }
        Scalar solid = 0;
        for (std::uint32_t k = boundary_pairs.start[i]; k < boundary_pairs.start[i + 1]; ++k) {
            solid += boundary[boundary_pairs.index[k]][3] * boundary_pairs.gradient[k][3];
        }
        density[i] = mass * water + rho0 * solid;
    });
}

} // namespace flotsam
