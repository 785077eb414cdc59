#pragma once

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

namespace flotsam::scene {

/// Drives `a` against `b` about or along an axis of b at a velocity, with no more than a given torque or force.
///
/// **Rejected:** the motors of Bullet's own constraints. One of a hinge is bounded by an impulse, so its torque would
/// change with the step; and where a limit is reached, motor and limit share a row of the solver, which then has no
/// bound away from the limit.
class JointMotor final : public btTypedConstraint {
  public:
    struct Drive {
        bool turns;        ///< about the axis, else along it
        btVector3 point_a; ///< of a, on the line along which a force acts; in the frame of a
        btVector3 axis_b;  ///< in the frame of b
        btScalar velocity; ///< [rad/s] or [m/s]
        btScalar strength; ///< [N m] or [N]
    };
    JointMotor(btRigidBody& a, btRigidBody& b, const Drive& drive);

    void getInfo1(btConstraintInfo1* info) override;
    void getInfo2(btConstraintInfo2* info) override;
    void setParam(int, btScalar, int) override {}
    [[nodiscard]] btScalar getParam(int, int) const override { return 0; }

  private:
    Drive drive_;
};

} // namespace flotsam::scene
