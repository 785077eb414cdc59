#pragma once

#include "bullet/constrained_motion.hpp"

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

#include <vector>

namespace flotsam {

/// What one side of a row acts on: a link of a multibody, a rigid body, or the world, which does not move.
struct RowEnd {
    btMultiBody* multibody = nullptr;
    int link = 0; ///< 0 is the base, k + 1 Bullet's link k
    btRigidBody* body = nullptr;
};

/// One scalar velocity constraint between two twists (world frame, about the centres of mass):
/// jacobian_a . twist_a + jacobian_b . twist_b + cfm * impulse = target with impulse in [lower, upper]; complementarity
/// at the limits.
struct MultibodyRow {
    RowEnd a, b;
    Vec6d jacobian_a = Vec6d::Zero(), jacobian_b = Vec6d::Zero();
    double target = 0.0;             ///< [m/s] or [rad/s]
    double cfm = 0.0;                ///< [velocity per impulse]
    double lower = 0.0, upper = 0.0; ///< [N s] or [N m s]
    int number = 0;                  ///< of the row in its constraint: getAppliedImpulse(number) after Bullet's step
};

/// Rows of a btMultiBodyConstraint for the coming step.
///
/// Targets and limits are Bullet's own (createConstraintRows), whose row is: impulse = (error of position and gain k of
/// velocity) / own mobility. With gain 1 that is a target velocity; with 0 < k < 1 (kd of a btMultiBodyJointMotor,
/// damping of a btMultiBodySphericalJointMotor) a target velocity and cfm = own mobility (1/k - 1), exactly where no
/// other row acts on the multibody; with 0 an impulse that is given. Gains above 1 and the clamp of a motor's speed are
/// taken at the multibody's velocity now, where Bullet takes them after forces.
///
/// **Differs** where a rigid body is one of the ends: Bullet's row takes that body's velocity without the forces of the
/// step, so that it lags behind the target by what they change; ours does not.
class MultibodyRows {
  public:
    /// Appends the constraint's rows that are active; false for a kind that has no rows between two twists (the gear,
    /// which couples up to four). The multibodies must have been read (MultibodyMotion::read) at this pose. Nothing of
    /// the constraint changes but the positions that Bullet keeps of its rows.
    bool append(btMultiBodyConstraint& constraint, double dt, const btContactSolverInfo& info,
                std::vector<MultibodyRow>& rows);

  private:
    [[nodiscard]] MultibodyRow converted(btMultiBodyConstraint& constraint,
                                         const btMultiBodySolverConstraint& row) const;
    [[nodiscard]] RowEnd end(btMultiBody* multibody, int link, int solver_body) const;
    [[nodiscard]] double velocity(const btMultiBodySolverConstraint& row) const;
    [[nodiscard]] double own_mobility(const btMultiBodySolverConstraint& row) const;

    btMultiBodyConstraintArray bullet_rows_;
    btMultiBodyJacobianData data_;
    btAlignedObjectArray<btSolverBody> solver_bodies_;
};

/// Torque [N m] or force [N] about or along the axis of a constraint's row in Bullet's last step of `dt`.
///
/// Bullet leaves the impulse of a row that is not active as it was: a limit that is let go of goes on reporting its
/// last one. So a limit's row counts only where it was active (its position <= 0).
[[nodiscard]] double row_force(btMultiBodyConstraint& constraint, int row, double dt);

} // namespace flotsam
