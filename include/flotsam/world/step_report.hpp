#pragma once

#include "flotsam/world/ledger.hpp"

#include <array>

namespace flotsam {

/// Seconds of wall clock per stage of a step: `bodies` has the sampling of walls that water comes near as well, and
/// `walls`, the guard, is a part of `advance`.
struct StageSeconds {
    double bodies = 0.0, neighbours = 0.0, density = 0.0, forces = 0.0, pressure = 0.0, advance = 0.0, walls = 0.0;
};

/// What one FluidWorld::step did. Physics in trouble is counted here, never printed.
struct StepReport {
    double dt = 0.0;               ///< [s]
    int iterations = 0;            ///< of the velocity solve (published: of the one solve), in all rounds
    int rounds = 1;                ///< of that solve, until joints and contacts held and yielded as it had them
    int shift_iterations = 0;      ///< of the density solve of the split
    int products = 0;              ///< with the pressure system's matrix in both: what the solves cost
    bool converged = true;         ///< every solve reached its tolerance
    double disagreement = 0.0;     ///< velocity that the engine gave a body beside what the fluid believed in [m/s];
                                   ///< riding on an application's ticks: of the tick before
    double residual = 0.0;         ///< of the returned step: mean / rest density [-]
    double compression_mean = 0.0; ///< mean over the fluid of max(0, rho/rho0 - 1)
    double compression_max = 0.0;
    int leaks_stopped = 0;     ///< particles that the wall guard put back in this step
    int leaked = 0;            ///< particles that are outside all the same
    int removed_particles = 0; ///< before the step: in the way of bodies that were added, reshaped or put there; fallen
    int fallen_particles = 0;  ///< those of them that left over an open side and fell out of reach of everything
    Vec3d removed_momentum = Vec3d::Zero(); ///< theirs [kg m/s]
    double max_speed = 0.0;                 ///< of the fluid [m/s]
    Vec3d fluid_momentum = Vec3d::Zero();   ///< after the step [kg m/s]
    Vec3d gravity_impulse = Vec3d::Zero();  ///< given to the fluid by gravity in this step [N s]
    Vec3d wall_impulse = Vec3d::Zero();     ///< given to all walls by the fluid (pressure, viscosity, guard) [N s]
    Vec3d body_impulse = Vec3d::Zero();     ///< given to all bodies by the fluid [N s]
    Vec3d guard_impulse = Vec3d::Zero();    ///< the guard's part of wall_impulse + body_impulse [N s]
    Ledger ledger;                          ///< of this step: the same and more, by cause
    StageSeconds seconds;
};

/// How far water that starts at rest is on its way there.
struct SettleProgress {
    int rounds = 0, most_rounds = 0; ///< made, and how many there may be
    double speed = 0.0;              ///< mean of the water in the last of them [m/s]
    double still_speed = 0.0;        ///< under which it counts as still [m/s]
    bool is_last = false;            ///< no round comes after this one
};

} // namespace flotsam
