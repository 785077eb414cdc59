#include "scene/bullet_joint.hpp"

#include "scene/bullet_shapes.hpp"

#include <cmath>
#include <numbers>

namespace flotsam::scene {
namespace {

using Type = SceneJoint::Type;

/// The joint's frame in the world as the scene starts: z is its axis, and in 2-D y or x is the world's y.
btTransform start_frame(const SceneJoint& joint)
{
    const Vec3d z = joint.axis.isZero(0.0) ? Vec3d(Vec3d::UnitZ()) : joint.axis;
    const Vec3d x = z.unitOrthogonal(), y = z.cross(x);
    btMatrix3x3 axes;
    for (int k = 0; k < 3; ++k) axes[k] = btVector3(to_scalar(x[k]), to_scalar(y[k]), to_scalar(z[k]));
    return btTransform(axes, to_bullet(joint.point));
}

/// Bullet's slider goes along x.
btTransform z_to_x(const btTransform& frame)
{
    const btMatrix3x3 turn(0, 1, 0, 0, 0, 1, 1, 0, 0); // its columns: x is z, y is x, z is y
    return btTransform(frame.getBasis() * turn, frame.getOrigin());
}

std::unique_ptr<btTypedConstraint> hinge(const SceneJoint& joint, btRigidBody& a, btRigidBody& b,
                                         const btTransform& in_a, const btTransform& in_b)
{
    auto made = std::make_unique<btHingeConstraint>(a, b, in_a, in_b);
    made->setUseFrameOffset(false); // with it a body held by a limit cannot leave it
    // no softness, all of the error taken into account, no bounce
    if (joint.limits) made->setLimit(to_scalar(joint.limits->low), to_scalar(joint.limits->high), 1, 1, 0);
    return made;
}

std::unique_ptr<btTypedConstraint> slider(const SceneJoint& joint, btRigidBody& a, btRigidBody& b,
                                          const btTransform& in_a, const btTransform& in_b)
{
    // false: positions are those of a along the axis, seen from b
    auto made = std::make_unique<btSliderConstraint>(a, b, z_to_x(in_a), z_to_x(in_b), false);
    made->setLowerAngLimit(0);
    made->setUpperAngLimit(0);
    if (joint.limits) {
        made->setLowerLinLimit(to_scalar(joint.limits->low));
        made->setUpperLinLimit(to_scalar(joint.limits->high));
    }
    return made;
}

std::unique_ptr<btTypedConstraint> constraint_of(const SceneJoint& joint, btRigidBody& a, btRigidBody& b,
                                                 const btTransform& in_a, const btTransform& in_b)
{
    if (joint.type == Type::hinge) return hinge(joint, a, b, in_a, in_b);
    if (joint.type == Type::slider) return slider(joint, a, b, in_a, in_b);
    return std::make_unique<btPoint2PointConstraint>(a, b, in_a.getOrigin(), in_b.getOrigin());
}

} // namespace

BulletJoint::BulletJoint(const SceneJoint& joint, btRigidBody& a, btRigidBody& b, btDynamicsWorld& world)
    : type_(joint.type), has_axis_(!joint.axis.isZero(0.0)), a_(a), b_(b), world_(world)
{
    const btTransform frame = start_frame(joint);
    in_a_ = a.getCenterOfMassTransform().inverse() * frame;
    in_b_ = b.getCenterOfMassTransform().inverse() * frame;
    constraint_ = constraint_of(joint, a, b, in_a_, in_b_);
    constraint_->setJointFeedback(&on_a_);
    world_.addConstraint(constraint_.get(), true);
    if (joint.motor) {
        motor_ = std::make_unique<JointMotor>(
            a, b,
            JointMotor::Drive{type_ == Type::hinge, in_a_.getOrigin(), in_b_.getBasis().getColumn(2),
                              to_scalar(joint.motor->velocity), to_scalar(joint.motor->strength)});
        motor_->setJointFeedback(&motor_on_a_);
        world_.addConstraint(motor_.get(), true);
    }
    arm_ = arm();
}

BulletJoint::~BulletJoint()
{
    if (motor_) world_.removeConstraint(motor_.get());
    world_.removeConstraint(constraint_.get());
}

void BulletJoint::update()
{
    Wrench wrench{from_bullet(on_a_.m_appliedForceBodyA), from_bullet(on_a_.m_appliedTorqueBodyA)};
    if (motor_) wrench += {from_bullet(motor_on_a_.m_appliedForceBodyA), from_bullet(motor_on_a_.m_appliedTorqueBodyA)};
    wrench.angular += arm_.cross(wrench.linear); // Bullet's torque is about the centre of mass
    now_.wrench = wrench;
    arm_ = arm();
    const double position = measured_position();
    const bool may_turn_round = type_ != Type::slider && has_axis_;
    now_.position =
        may_turn_round ? now_.position + std::remainder(position - now_.position, 2.0 * std::numbers::pi) : position;
}

double BulletJoint::measured_position() const
{
    const btTransform a = a_.getCenterOfMassTransform() * in_a_, b = b_.getCenterOfMassTransform() * in_b_;
    if (type_ == Type::slider)
        return static_cast<double>((a.getOrigin() - b.getOrigin()).dot(b.getBasis().getColumn(2)));
    const Quatd turned = from_bullet(b.inverse() * a).orientation;
    if (has_axis_) return 2.0 * std::atan2(turned.z(), turned.w());
    return 2.0 * std::atan2(turned.vec().norm(), std::abs(turned.w()));
}

Vec3d BulletJoint::arm() const
{
    return from_bullet(a_.getCenterOfMassPosition() - a_.getCenterOfMassTransform() * in_a_.getOrigin());
}

} // namespace flotsam::scene
