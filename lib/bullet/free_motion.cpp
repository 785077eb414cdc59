#include "bullet/free_motion.hpp"

#include "bullet/convert.hpp"

namespace flotsam {

namespace {

/// Angular velocity change by gyroscopic terms, as btSequentialImpulseConstraintSolver::convertBodies adds it.
btVector3 gyroscopic_change(const btRigidBody& body, btScalar dt, btScalar max_force)
{
    btVector3 change(0, 0, 0);
    const int flags = body.getFlags();
    if (flags & BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT)
        change -= body.computeGyroscopicForceExplicit(max_force) * body.getInvInertiaTensorWorld() * dt;
    if (flags & BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD) change += body.computeGyroscopicImpulseImplicit_World(dt);
    if (flags & BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY) change += body.computeGyroscopicImpulseImplicit_Body(dt);
    return change;
}

} // namespace

FreeMotion free_motion(btRigidBody& body, double dt, btScalar max_gyroscopic_force, bool has_gravity)
{
    const btVector3 linear = body.getLinearVelocity(), angular = body.getAngularVelocity();
    const auto step = static_cast<btScalar>(dt);
    body.updateInertiaTensor(); // stale after btCollisionObject::setWorldTransform
    body.applyDamping(step);
    const btVector3 damped_linear = body.getLinearVelocity(), damped_angular = body.getAngularVelocity();

    btVector3 gravity(0, 0, 0); // an acceleration
    if (!has_gravity) gravity = body.getGravity() * body.getLinearFactor();
    const btVector3 end_linear = damped_linear + (body.getTotalForce() * body.getInvMass() + gravity) * step;
    const btVector3 end_angular = damped_angular + body.getTotalTorque() * body.getInvInertiaTensorWorld() * step +
                                  gyroscopic_change(body, step, max_gyroscopic_force);
    body.setLinearVelocity(linear);
    body.setAngularVelocity(angular);
    return {twist_from_bullet(damped_linear, damped_angular), twist_from_bullet(end_linear, end_angular)};
}

} // namespace flotsam
