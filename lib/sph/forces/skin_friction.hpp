#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "sph/contacts.hpp"
#include "sph/pressure/pressure_system.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// Mean friction of water that flows along a flat plate, C = tau / (rho U^2 / 2), by its length: 1.328 / sqrt(Re)
/// (Blasius 1908), and above Re = 5e5, where that is more, 0.074 / Re^(1/5) - 1742 / Re (Prandtl 1927). Re > 0.
/// **Source:** Schlichting, Boundary-Layer Theory.
[[nodiscard]] double plate_friction(double reynolds);

struct SkinFrictionSettings {
    double kinematic_viscosity = 0.0; ///< nu [m^2/s], > 0
    double spacing = 0.0;             ///< d [m]
    double rest_density = 1000.0;     ///< [kg/m^3]
    int dimensions = 3;
};

/// What water that flows along bodies in layers thinner than a spacing rubs off them.
///
/// The boundary layer of water is millimetres thick. Viscosity between particles and samples spreads it over a spacing
/// and has next to no hold on light bodies, which ride on the uppermost particles: they slid on for ever. A body has
/// the wetted area A: that of its samples within reach of particles under pressure. It is shared among these particles
/// i in proportion to their contact |row_i|, and each rubs as the mean of a plate of the length sqrt(A) (in 2-D A)
/// does that water passes at its own slip u_i along the surface,
///
///     tau_i = rho u_i^2 / 2 C(u_i sqrt(A) / nu).
///
/// A particle and the body exchange tau_i A_i dt, at the particle: linear and angular momentum are kept. What viscosity
/// has rubbed off the body already is taken off, in thick fluids all. Impulses are cut where they would take more than
/// half of a particle's slip, or, all those of a body, would give it and the water energy.
class SkinFriction {
  public:
    /// Adds to `velocity` (which is not read: the state's velocities are), and the bodies' impulses about `centers` to
    /// `owner_impulses` [N s], [N m s], which have those of Viscosity. `contacts`: of the owners, walls first; `walls`:
    /// how many of them are; `twists`: of the owners at the start of the step; `respond`: how bodies answer impulses.
    void add(const SkinFrictionSettings& settings, double dt, const FluidState& fluid, const BoundaryState& boundary,
             const Pairs& boundary_pairs, const Contacts& contacts, std::size_t walls, std::span<const Vec3d> centers,
             std::span<const Twist> twists, OwnerResponse respond, const Workers& workers, std::span<Vec4> velocity,
             std::span<Wrench> owner_impulses);

  private:
    /// Of the impulses of a body.
    struct Sum {
        Wrench impulse;
        double slowed = 0.0;  ///< sum of J . u: the energy that they take to first order [J]
        double inertia = 0.0; ///< sum of J^2 / m [J]
        Sum& operator+=(const Sum& other);
    };
    void find_wet_samples(const FluidState& fluid, const BoundaryState& boundary, const Pairs& boundary_pairs,
                          const Contacts& contacts, std::size_t walls, const Workers& workers);
    [[nodiscard]] double wetted_area(std::size_t owner, const SkinFrictionSettings& settings) const;

    std::vector<std::uint8_t> is_wet_;   ///< of each sample
    std::vector<std::size_t> wet_count_; ///< of each owner
    std::vector<Vec4> impulses_;         ///< of each row of contacts
    std::vector<double> weights_;
    std::vector<Sum> scratch_, sums_; ///< sums_: of each owner
    std::vector<Wrench> offered_;
    std::vector<Twist> answers_;
};

} // namespace flotsam
