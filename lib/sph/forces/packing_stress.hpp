#pragma once

#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "sph/contacts.hpp"
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

/// Walls and bodies, as the water feels them.
struct TouchedSolids {
    const BoundaryState& boundary;
    const Pairs& pairs; ///< of particles with samples
    const Contacts& contacts;
    std::span<const Vec3d> centers; ///< of each owner [m]
    std::span<const Scalar> moving; ///< of each owner: RecentSlip's shares
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
/// Particles that touch the samples of a solid at rest count as T = 0: the stress of these layers is small, but since p
/// grows with the depth, even 0.01 p would drive a current along the solid, which grows for minutes. In the layer
/// behind them only what opposes the flow is taken away, for the same reason: the part of <T> along the strain rate D
/// of the particle, D (<T> : D) / (D : D), which the shear of a current along a wall does not have. Farther away a
/// packing at rest has less than 0.001 p.
///
/// Along a body that moves against the water (RecentSlip) the layer that touches it is strained like the rest, by x / R
/// when a body of radius R has moved by x, and bears up to 0.1 p: it would hold the body like a spring, and yield only
/// after a tenth of a spacing. Its T counts the pairs with samples too, of which there are rho0 V_b / m, with p_i
/// alone; of it the part is taken away that stands across the surface, n T n (n n - I / dim) dim / (dim - 1), n the
/// normal (what lies along it only damps, and holds currents back); the mean is over particles that touch samples; and
/// the samples take what the water that is not behind them would: each counts as 1.44 rho0 V_b / m particles with T_b =
/// <T>_i. (1.44: so that a layer of samples bears a uniform T like water on a lattice does; 1.36 to 1.49 for both
/// kernels in 2-D and 3-D.) What is taken away is a force within the step that pairs exert on each other, so that no
/// balance of a body at rest depends on it.
///
/// |<T>| is at most 0.03 p, 0.12 p along moving bodies: in flows it is 0.003 to 0.005 p, and near a free surface, where
/// half of the neighbours are missing, the virial is no measure of the stress.
///
/// **Source:** Irving & Kirkwood 1950 for the virial; bench_strength and bench_release have what it does.
class PackingStress {
  public:
    /// Adds dt a_i to `velocity` (which is not read: the state's velocities are) and the reaction impulses about the
    /// solids' centres to `owner_impulses` [N s], [N m s].
    void relieve(const PackingStressSettings& settings, double dt, const FluidState& fluid,
                 const SelfPairs& fluid_pairs, const TouchedSolids& solids, const Workers& workers,
                 const ForceScratch& scratch, std::span<Vec4> velocity, std::span<Wrench> owner_impulses);

  private:
    void find_layers(const SelfPairs& fluid_pairs, const TouchedSolids& solids, const Workers& workers);
    /// The pairs of particles with the samples of moving bodies, for stresses <T> as simd::sum_deviator_pushes has
    /// them.
    void push_samples(const FluidState& fluid, const TouchedSolids& solids, std::span<const Vec4> at,
                      std::span<const Vec4> rest, Scalar factor, double rest_density, const Workers& workers,
                      std::span<Vec4> velocity, std::span<Wrench> owner_impulses);

    std::vector<std::uint8_t> second_layer_; ///< 1: a neighbour touches boundary samples
    std::vector<std::uint8_t> moved_;        ///< of those that touch bodies that move: the share of these, 1 to 255
    std::vector<Wrench> reactions_;
};

} // namespace flotsam
