#pragma once

#include "flotsam/world/fluid_forces.hpp"

namespace flotsam {

/// What the fluid has at one time. Angular momentum is about the world's origin. In two dimensions all is per metre.
struct FluidTotals {
    Vec3d momentum = Vec3d::Zero();         ///< [N s]
    Vec3d angular_momentum = Vec3d::Zero(); ///< [N m s]
    double kinetic = 0.0;                   ///< [J]
    double potential = 0.0;                 ///< sum of -m g . x [J]
    double volume = 0.0;                    ///< of its particles at rest density [m^3]

    [[nodiscard]] double energy() const { return kinetic + potential; }
    FluidTotals& operator+=(const FluidTotals& other);
    [[nodiscard]] FluidTotals operator-(const FluidTotals& other) const;
};

/// Energy [J] that went through or out of the fluid, by cause.
///
/// A change of velocity dv of a particle does the work m dv . (v_start + v_end) / 2, with the velocities at both ends
/// of the step, so that the works of all causes add up to the kinetic energy gained. An impulse on a body gives it
/// impulse . (twist_start + twist_end) / 2. What a cause takes from the fluid and does not give to solids is lost.
struct EnergyLedger {
    double gravity = 0.0;     ///< work on the fluid: from potential to kinetic
    ByCause<double> walls;    ///< given by the fluid; 0: they stand still
    ByCause<double> bodies;   ///< given by the fluid
    double viscous = 0.0;     ///< lost to viscosity and dissipation, less what packing_relief gives back
    double compression = 0.0; ///< lost by pressure against changes of density (a splash), which store nothing
    double guard = 0.0;       ///< lost as the guard stopped particles
    double shift = 0.0;       ///< potential energy gained by the position shift
    /// Potential energy gained as positions move with the velocity of the step's end, not its mean (swings with the
    /// flow, -dt g . momentum / 2), and are rounded to single precision.
    double integration = 0.0;

    EnergyLedger& operator+=(const EnergyLedger& other);
};

/// What did not add up; rounding, if nothing is wrong.
struct LedgerErrors {
    Vec3d momentum = Vec3d::Zero();         ///< [N s]
    Vec3d angular_momentum = Vec3d::Zero(); ///< [N m s]
    double energy = 0.0;                    ///< [J]
    double volume = 0.0;                    ///< [m^3]
};

/// Largest amounts of one cause or one change [N s], [N m s], [J]: what errors are measured by.
struct LedgerScales {
    double momentum = 0.0, angular_momentum = 0.0, energy = 0.0;
};

/// Books of the fluid's momentum, energy and volume over a step or, added up, over several that follow each other.
///
///     end - start = gravity - walls - bodies - removed                                  (linear momentum)
///     end - start = gravity - walls - bodies - removed + shift                          (angular)
///     end - start = shift + integration - walls - bodies - viscous - compression - guard - removed   (energy)
///
/// The two sides are reckoned apart: the left from the particles, impulses on solids from what these were given. All
/// sums are in double, in a fixed order; the errors are the rounding of velocities in single precision.
struct Ledger {
    double seconds = 0.0;
    FluidTotals start, end;
    /// What went before a step or between steps, with particles that bodies took the room of; put in: negative. Water
    /// that was moved aside is in it too, by what its place is worth.
    FluidTotals removed;
    Wrench gravity;                ///< impulse given to the fluid, and its moment about the origin
    ByCause<Wrench> walls, bodies; ///< impulses given by the fluid, moments about the origin
    /// Angular momentum gained by the position shift, sum of m shift x v, and as positions are rounded to single
    /// precision [N m s].
    Vec3d shift = Vec3d::Zero();
    EnergyLedger energy;
    double compressed = 0.0; ///< integral of max(0, rho / rho0 - 1) over the fluid, mean over time [m^3]

    /// Appends what came next.
    Ledger& operator+=(const Ledger& next);
    [[nodiscard]] LedgerErrors errors() const;
    [[nodiscard]] LedgerScales scales() const;
};

} // namespace flotsam
