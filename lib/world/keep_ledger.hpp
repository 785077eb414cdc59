#pragma once

#include "flotsam/core/types.hpp"

namespace flotsam {

/// Sums over the particles that the ledger of a step is made of; of unit masses.
struct LedgerSums {
    Vec3d velocity_before = Vec3d::Zero(), velocity_after = Vec3d::Zero();
    Vec3d position_before = Vec3d::Zero(), position_after = Vec3d::Zero();
    Vec3d spin_before = Vec3d::Zero(), spin_after = Vec3d::Zero();
    Vec3d shift = Vec3d::Zero(), shift_spin = Vec3d::Zero();
    Vec3d drift = Vec3d::Zero();    ///< displacement beside the shift and dt times the mean velocity of the step
    Vec3d put_back = Vec3d::Zero(); ///< displacement by the guard
    double speed_sq_before = 0.0, speed_sq_after = 0.0; ///< twice the kinetic energy
    double viscous = 0.0, pressure = 0.0, guard = 0.0;  ///< works

    LedgerSums& operator+=(const LedgerSums& other);
};

} // namespace flotsam
