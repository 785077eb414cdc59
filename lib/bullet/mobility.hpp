#pragma once

#include "flotsam/core/types.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace flotsam {

/// How one free rigid body answers impulses about its centre of mass, locked axes included. World frame.
struct Mobility {
    Vec3d linear = Vec3d::Zero();   ///< twist per impulse, diagonal [1/kg]
    Mat3d angular = Mat3d::Zero();  ///< symmetric, positive semi-definite [1/(kg m^2)]
    Mat3d held = Mat3d::Identity(); ///< what locked axes leave of an angular velocity change that ignores them

    [[nodiscard]] Twist operator*(const Wrench& impulse) const
    {
        return {linear.cwiseProduct(impulse.linear), angular * impulse.angular};
    }
};

/// Mobility of a dynamic body from its mass, world inertia, linear and angular factors.
///
/// A locked rotation axis (factor 0) is a constraint, so the mobility of the others is the inverse of their block of
/// the inertia, (F I F)^+. **Differs** from Bullet, which drops the locked components of I^-1 t: that is not
/// symmetric, and a pressure solve with it inside would not converge. Other factors f scale by sqrt(f) on both sides.
[[nodiscard]] Mobility mobility_of(const btRigidBody& body);

} // namespace flotsam
