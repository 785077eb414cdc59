#include "bullet/multibody_constraint_access.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyFixedConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <BulletDynamics/Featherstone/btMultiBodySliderConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodySphericalJointMotor.h>

#include <cmath>

namespace flotsam {

namespace {

/// Bullet keeps these to derived classes.
template <class Constraint>
struct Protected : Constraint {
    static RigidEnds rigid_ends(const Constraint& constraint)
    {
        return {constraint.*(&Protected::m_rigidBodyA), constraint.*(&Protected::m_rigidBodyB)};
    }
};
struct ProtectedMotor : btMultiBodyJointMotor {
    static double gain(const btMultiBodyJointMotor& motor)
    {
        return static_cast<double>(motor.*(&ProtectedMotor::m_kd));
    }
    static double fastest(const btMultiBodyJointMotor& motor)
    {
        return static_cast<double>(motor.*(&ProtectedMotor::m_rhsClamp));
    }
};

template <class Constraint>
RigidEnds rigid_ends_of(const btMultiBodyConstraint& constraint)
{
    return Protected<Constraint>::rigid_ends(static_cast<const Constraint&>(constraint));
}

} // namespace

RigidEnds rigid_ends(const btMultiBodyConstraint& constraint)
{
    switch (constraint.getConstraintType()) {
    case MULTIBODY_CONSTRAINT_POINT_TO_POINT:
        return rigid_ends_of<btMultiBodyPoint2Point>(constraint);
    case MULTIBODY_CONSTRAINT_FIXED:
        return rigid_ends_of<btMultiBodyFixedConstraint>(constraint);
    case MULTIBODY_CONSTRAINT_SLIDER:
        return rigid_ends_of<btMultiBodySliderConstraint>(constraint);
    default:
        return {};
    }
}

double velocity_gain(const btMultiBodyConstraint& constraint, int row, double aim)
{
    if (constraint.getConstraintType() == MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR) {
        const auto& motor = static_cast<const btMultiBodyJointMotor&>(constraint);
        const double fastest = ProtectedMotor::fastest(motor);
        const bool is_clamped = std::abs(aim) >= fastest * (1.0 - 100.0 * static_cast<double>(SIMD_EPSILON));
        return is_clamped ? 1.0 : ProtectedMotor::gain(motor);
    }
    if (constraint.getConstraintType() == MULTIBODY_CONSTRAINT_SPHERICAL_MOTOR)
        return static_cast<double>(static_cast<const btMultiBodySphericalJointMotor&>(constraint).getDamping(row));
    return 1.0;
}

} // namespace flotsam
