#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

namespace flotsam {

/// What Bullet's multibody constraints have no getter for.
struct RigidEnds {
    btRigidBody* a = nullptr;
    btRigidBody* b = nullptr;
};

/// Rigid bodies at the ends of a point-to-point, fixed or slider constraint; none for other kinds.
[[nodiscard]] RigidEnds rigid_ends(const btMultiBodyConstraint& constraint);

/// Part of the velocity error that a row of the constraint takes away in a step (kd of a joint motor, damping of a ball
/// joint's motor; 1 for other kinds). `aim` is the velocity that Bullet's row aims at, which a joint motor may clamp:
/// at the clamp it aims at that velocity in full.
[[nodiscard]] double velocity_gain(const btMultiBodyConstraint& constraint, int row, double aim);

} // namespace flotsam
