#pragma once

#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "sph/forces/force_scratch.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

struct PackingStressSettings {
    double relief = 0.0;          ///< share of the stress that is taken away, 0 to 1
    double rest_density = 1000.0; ///< [kg/m^3]
    int dimensions = 3;
};

/// Takes away the stress by which a packing of particles resists a change of shape, and water does not.
///
/// Each particle's density is a constraint, and a flow that strains the packing leaves it anisotropic until particles
/// change places: the pressure forces between them, -m^2 (p_i/rho_i^2 + p_j/rho_j^2) grad W_ij, then bear a stress that
/// differs from p by a deviator T, in proportion to the pressure. It acts like a viscosity of about d sqrt(rho p):
/// waves die, what is let go under water starts too slowly, and the more so the deeper the water. T is measured, by the
/// virial theorem, with the pressures that the last step left; made smooth; and its divergence taken from the forces:
///
///     T_i = dev( 1/(2 V) sum_j f_ij x_ij^T ),   <T>_i = sum_j w_ij T_j / sum_j w_ij,   w_ij = -grad W_ij . x_ij
///     a_i = (dim + 2) / 2 m / rho0^2 sum_j (e^T (<T>_i + <T>_j) e) grad W_ij,   e = x_ij / |x_ij|
///
/// What order the particles keep among themselves is below the scale of the smoothing and stays. Each pair's force lies
/// along x_ij: linear and angular momentum are kept. (Such forces have the stress <T> where no direction is preferred,
/// since the mean of e e e e : T is 2 T / (dim (dim + 2)); along a lattice's axes 1.3 times that, so that a relief of
/// 0.75 takes 0.75 to 1 of it; with more, still water would not come to rest.) The work is what the packing takes out
/// of the flow and turns into heat; the dissipation of velocity noise (Viscosity) takes the heat away.
///
/// Particles that touch boundary samples count as T = 0: the layers along a solid are anisotropic at rest, by up to
/// 0.2 p, and taking that away would stir the water. In the layer behind them it is 0.004 p, and since p grows with the
/// depth, even that would drive a current along the walls, which grows for minutes. What is taken away there is only
/// what opposes the flow: the part of <T> along the strain rate D of the particle, D (<T> : D) / (D : D), which the
/// shear of a current along a wall does not have. Farther away a packing at rest has less than 0.001 p.
///
/// |<T>| is at most 0.03 p: in flows it is 0.003 to 0.005 p, and near a free surface, where half of the neighbours are
/// missing, the virial is no measure of the stress.
///
/// **Source:** Irving & Kirkwood 1950 for the virial; bench_strength has what it does.
class PackingStress {
  public:
    /// Adds dt a_i to `velocity` (which is not read: the state's velocities are).
    void relieve(const PackingStressSettings& settings, double dt, const FluidState& fluid,
                 const SelfPairs& fluid_pairs, const Pairs& boundary_pairs, const Workers& workers,
                 const ForceScratch& scratch, std::span<Vec4> velocity);

  private:
    void find_second_layer(const SelfPairs& fluid_pairs, const Pairs& boundary_pairs, const Workers& workers);

    std::vector<std::uint8_t> second_layer_; ///< 1: a neighbour touches boundary samples
};

} // namespace flotsam
