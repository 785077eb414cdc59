#include "scene/joint_motor.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace flotsam::scene {
namespace {

void set(btScalar* row, const btVector3& v)
{
    for (int k = 0; k < 3; ++k) row[k] = v[k];
}

} // namespace

JointMotor::JointMotor(btRigidBody& a, btRigidBody& b, const Drive& drive)
    : btTypedConstraint(MAX_CONSTRAINT_TYPE, a, b), drive_(drive)
{
}

void JointMotor::getInfo1(btConstraintInfo1* info)
{
    info->m_numConstraintRows = 1;
    info->nub = 0;
}

void JointMotor::getInfo2(btConstraintInfo2* info)
{
    const btTransform &a = m_rbA.getCenterOfMassTransform(), &b = m_rbB.getCenterOfMassTransform();
    const btVector3 axis = b.getBasis() * drive_.axis_b;
    if (drive_.turns) {
        set(info->m_J1angularAxis, axis);
        set(info->m_J2angularAxis, -axis);
    } else {
        const btVector3 point = a * drive_.point_a; // one for both bodies: the two forces lie on a line
        set(info->m_J1linearAxis, axis);
        set(info->m_J2linearAxis, -axis);
        set(info->m_J1angularAxis, (point - a.getOrigin()).cross(axis));
        set(info->m_J2angularAxis, axis.cross(point - b.getOrigin()));
    }
    *info->m_constraintError = drive_.velocity;
    *info->m_lowerLimit = -drive_.strength / info->fps; // an impulse
    *info->m_upperLimit = drive_.strength / info->fps;
}

} // namespace flotsam::scene
