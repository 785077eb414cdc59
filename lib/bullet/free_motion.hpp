#pragma once

#include "flotsam/core/types.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace flotsam {

/// What one Bullet step makes of an awake dynamic body that nothing touches.
struct FreeMotion {
    Twist damped; ///< its velocity after damping
    Twist end;    ///< at the end of the step: damped, then gravity, applied forces and the gyroscopic term added
};

/// The same operations in the same order as btDiscreteDynamicsWorld::stepSimulation(dt, 0) of Bullet 3.24:
/// applyGravity, applyDamping, then the solver's external force and torque impulses. Damping and gyroscopic terms are
/// computed by Bullet's own functions on the body, whose velocity is put back afterwards. The body's world inertia is
/// brought up to date. `has_gravity`: applyGravity is done already, as in a tick.
[[nodiscard]] FreeMotion free_motion(btRigidBody& body, double dt, btScalar max_gyroscopic_force, bool has_gravity);

} // namespace flotsam
