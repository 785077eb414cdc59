#pragma once

#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "sph/forces/force_scratch.hpp"

#include <span>
#include <vector>

namespace flotsam {

struct ViscositySettings {
    double kinematic_viscosity = 0.0; ///< nu [m^2/s]
    double dissipation = 0.0;         ///< strength of the sub-resolution part [-]
    double spacing = 0.0;             ///< d [m]
    double rest_density = 1000.0;     ///< [kg/m^3]
    int dimensions = 3;
};

/// Physical viscosity, and dissipation of what the particles cannot resolve.
///
///     a_i = 2 (dim + 2) V sum_j (nu s_ij + nu_ij q_ij) / (|x_ij|^2 + 0.01 h^2) grad W_ij,   s_ij = v_ij . x_ij,   V =
///     m / rho0 nu_ij = dissipation d |q_ij| / |x_ij| q_ij = (v_ij - (G_i + G_j) x_ij / 2) . x_ij, limited to lie
///     between 0 and s_ij;   G_i the velocity gradient at i
///
/// The second part acts on velocity differences between neighbours that are not part of a locally linear field: a
/// particle fluid without it keeps the noise of its own rearrangement for ever. It is quadratic in the difference, so
/// it has no speed of its own and vanishes with the noise, and it is zero for any linear flow (shear, rotation,
/// strain). Between fluid particles only. A boundary sample counts as volume V_b in the first part and takes the
/// reaction. All forces lie along x_ij: linear and angular momentum are kept and energy never rises.
/// **Source:** Monaghan 2005, in the form of Koschier et al. 2019, eq. 23, for nu; von Neumann & Richtmyer 1950 for the
/// quadratic form; Frontiere, Raskin & Owen 2017 for taking the linear field away. **Differs:** G is renormalised
/// (Randles & Libersky 1996); the limiter is the interval above.
class Viscosity {
  public:
    /// Adds dt a_i to `velocity` (which is not read: the state's velocities are) and the reaction impulses about
    /// `centers` to `owner_impulses` [N s], [N m s].
    void add(const ViscositySettings& settings, double dt, const FluidState& fluid, const BoundaryState& boundary,
             const SelfPairs& fluid_pairs, const Pairs& boundary_pairs, std::span<const Vec3d> centers,
             const Workers& workers, const ForceScratch& scratch, std::span<Vec4> velocity,
             std::span<Wrench> owner_impulses);

  private:
    struct Reaction {
        std::int32_t owner;
        Wrench impulse;
    };
    void add_at_boundaries(const ViscositySettings& settings, double dt, const FluidState& fluid,
                           const BoundaryState& boundary, const Pairs& pairs, std::span<const Vec3d> centers,
                           const Workers& workers, std::span<Vec4> velocity, std::span<Wrench> owner_impulses);

    std::vector<std::vector<Reaction>> reactions_; ///< per chunk
};

} // namespace flotsam
