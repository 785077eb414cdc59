#include "bullet/kinematic_motion.hpp"

#include "bullet/convert.hpp"

#include <LinearMath/btMotionState.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace flotsam {

namespace {

/// Where Bullet will find the body at the end of the step.
btTransform target_pose(const btRigidBody& body)
{
    btTransform pose = body.getWorldTransform();
    if (body.getMotionState() != nullptr) body.getMotionState()->getWorldTransform(pose);
    return pose;
}

} // namespace

Pose KinematicMotion::start_pose(const btRigidBody& body)
{
    return from_bullet(body.getInterpolationWorldTransform()); // where Bullet's last step left it
}

void KinematicMotion::start(btRigidBody& body)
{
    *this = {};
    seen_pose_ = target_pose(body);
    body.setWorldTransform(seen_pose_);
    body.setInterpolationWorldTransform(seen_pose_);
}

Twist KinematicMotion::plan(const btRigidBody& body, double dt)
{
    const btTransform target = target_pose(body);
    if (!(target == seen_pose_)) {
        set_linear_ = set_angular_ = btVector3(0, 0, 0);
        btVector3 linear, angular;
        btTransformUtil::calculateVelocity(body.getInterpolationWorldTransform(), target, static_cast<btScalar>(dt),
                                           linear, angular);
        return twist_from_bullet(linear, angular);
    }
    const Twist now = twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
    if (!now.linear.allFinite() || !now.angular.allFinite()) return now; // the fluid refuses it: not to be kept
    if (!(body.getLinearVelocity() == seen_linear_) || !(body.getAngularVelocity() == seen_angular_)) {
        set_linear_ = body.getLinearVelocity();
        set_angular_ = body.getAngularVelocity();
    }
    return twist_from_bullet(set_linear_, set_angular_);
}

Twist KinematicMotion::plan_in_tick(const btRigidBody& body, double dt)
{
    const Pose target = from_bullet(body.getWorldTransform());
    const Twist mean = twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
    const bool stands = mean.linear.isZero(0.0) && mean.angular.isZero(0.0); // or was put there without a velocity
    if (!rides_ || stands) pose_in_tick_ = target;
    rides_ = true;
    if (stands) return {};
    const Eigen::AngleAxisd turn((target.orientation * pose_in_tick_.orientation.conjugate()).normalized());
    const Twist rest{(target.position - pose_in_tick_.position) / dt, turn.angle() / dt * turn.axis()};
    const double rest_rate = rest.linear.norm() + rest.angular.norm();
    const double part = std::min(1.0, (mean.linear.norm() + mean.angular.norm()) / std::max(rest_rate, 1e-300));
    return {part * rest.linear, part * rest.angular};
}

btTransform KinematicMotion::end_pose(const btRigidBody& body, double dt) const
{
    if (!has_velocity()) return target_pose(body);
    btTransform next;
    btTransformUtil::integrateTransform(seen_pose_, set_linear_, set_angular_, static_cast<btScalar>(dt), next);
    return next;
}

void KinematicMotion::move(btRigidBody& body, double dt) const
{
    if (!has_velocity() && target_pose(body) == seen_pose_) return;
    body.activate(true); // Bullet reads no pose of a sleeping kinematic body
    if (!has_velocity()) return;
    const btTransform next = end_pose(body, dt);
    if (body.getMotionState() != nullptr) body.getMotionState()->setWorldTransform(next);
    body.setWorldTransform(next);
}

void KinematicMotion::finish(const btRigidBody& body)
{
    seen_pose_ = target_pose(body);
    seen_linear_ = body.getLinearVelocity();
    seen_angular_ = body.getAngularVelocity();
}

} // namespace flotsam
