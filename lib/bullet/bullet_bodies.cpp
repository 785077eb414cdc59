#include "bullet/bullet_bodies.hpp"

#include "bullet/convert.hpp"
#include "bullet/free_motion.hpp"
#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {

namespace {

bool is_zero(const Vec3d& linear, const Vec3d& angular)
{
    return linear.isZero(0.0) && angular.isZero(0.0);
}

/// Makes Bullet's next step of `dt` change the body's velocity by `change` more. Factors are put aside for the moment:
/// they are in `change` already, and holding a locked axis takes a torque about it.
void push(btRigidBody& body, const Twist& change, double dt)
{
    const btVector3 linear_factor = body.getLinearFactor(), angular_factor = body.getAngularFactor();
    const Mat3d axes = from_bullet(body.getWorldTransform().getBasis());
    const Vec3d inertia = from_bullet(body.getLocalInertia()); // 0 where the body never turns
    const Vec3d torque = axes * inertia.asDiagonal() * axes.transpose() * change.angular / dt;
    body.setLinearFactor(btVector3(1, 1, 1));
    body.setAngularFactor(btVector3(1, 1, 1));
    body.applyCentralForce(to_bullet(change.linear * (static_cast<double>(body.getMass()) / dt)));
    body.applyTorque(to_bullet(torque));
    body.setLinearFactor(linear_factor);
    body.setAngularFactor(angular_factor);
}

} // namespace

int BulletBodies::add(btRigidBody& body)
{
    Coupled coupled;
    coupled.body = &body;
    bodies_.push_back(coupled);
    return static_cast<int>(bodies_.size()) - 1;
}

bool BulletBodies::contains(const btRigidBody& body) const
{
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Coupled& coupled) { return coupled.body == &body; });
}

btRigidBody& BulletBodies::body(int number) const
{
    require(number >= 0 && number < static_cast<int>(bodies_.size()), "a body's number must be one that add returned",
            number);
    return *bodies_[static_cast<std::size_t>(number)].body;
}

void BulletBodies::read(double dt, std::span<BodyState> states)
{
    require(dt > 0.0 && std::isfinite(dt), "a step must be > 0 s and finite", dt);
    require(states.size() == bodies_.size(), "read needs one state per body", states.size());
    dt_ = dt;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        Coupled& coupled = bodies_[k];
        const btRigidBody& body = *coupled.body;
        if (body.isKinematicObject() && !coupled.was_kinematic) coupled.kinematic.start(*coupled.body);
        coupled.was_kinematic = body.isKinematicObject();
        if (body.isKinematicObject())
            states[k] = read_kinematic(coupled, dt);
        else if (body.isStaticObject() || body.getActivationState() == DISABLE_SIMULATION)
            states[k] = read_static(coupled);
        else
            states[k] = read_dynamic(coupled, dt);
    }
}

BodyState BulletBodies::read_static(Coupled& coupled) const
{
    coupled.mobility = {};
    coupled.predicted = coupled.unaided = {};
    return {from_bullet(coupled.body->getWorldTransform()), coupled.predicted, false};
}

BodyState BulletBodies::read_kinematic(Coupled& coupled, double dt) const
{
    coupled.mobility = {};
    coupled.predicted = coupled.unaided = coupled.kinematic.plan(*coupled.body, dt);
    return {KinematicMotion::start_pose(*coupled.body), coupled.predicted, false, coupled.predicted};
}

BodyState BulletBodies::read_dynamic(Coupled& coupled, double dt) const
{
    btRigidBody& body = *coupled.body;
    const FreeMotion motion = free_motion(body, dt, world_.getSolverInfo().m_maxGyroscopicForce);
    coupled.is_asleep = !body.isActive();
    coupled.mobility = mobility_of(body);
    coupled.unaided = motion.end;
    coupled.predicted = {};
    Twist start;
    if (!coupled.is_asleep) {
        start = {from_bullet(body.getLinearVelocity()), from_bullet(body.getAngularVelocity())};
        const Vec3d turned = motion.end.angular - motion.damped.angular;
        const Vec3d leak = turned - coupled.mobility.held * turned; // about locked axes; exactly 0 without any
        coupled.predicted = {motion.end.linear, motion.end.angular - leak};
    }
    return {from_bullet(body.getWorldTransform()), coupled.predicted, true, start};
}

void BulletBodies::respond(std::span<const Wrench> impulses, std::span<Twist> twists) const
{
    FLOTSAM_ASSERT(impulses.size() == bodies_.size() && twists.size() == bodies_.size(), "one entry per body");
    for (std::size_t k = 0; k < bodies_.size(); ++k) twists[k] = bodies_[k].mobility * impulses[k];
}

void BulletBodies::apply(std::span<const Wrench> impulses)
{
    require(dt_ > 0.0 || bodies_.empty(), "apply needs a read before it");
    require(impulses.size() == bodies_.size(), "apply needs one impulse per body", impulses.size());
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const Coupled& coupled = bodies_[k];
        const bool is_touched = !is_zero(impulses[k].linear, impulses[k].angular);
        if (coupled.body->isStaticOrKinematicObject() || (coupled.is_asleep && !is_touched)) continue;
        if (is_touched) coupled.body->activate(true);
        const Twist answer = coupled.mobility * impulses[k];
        const Twist change{coupled.predicted.linear + answer.linear - coupled.unaided.linear,
                           coupled.predicted.angular + answer.angular - coupled.unaided.angular};
        if (!is_zero(change.linear, change.angular)) push(*coupled.body, change, dt_);
    }
}

void BulletBodies::before_bullet_step(double dt)
{
    for (Coupled& coupled : bodies_)
        if (coupled.was_kinematic && coupled.body->isKinematicObject()) coupled.kinematic.move(*coupled.body, dt);
}

void BulletBodies::after_bullet_step()
{
    for (Coupled& coupled : bodies_)
        if (coupled.was_kinematic) coupled.kinematic.finish(*coupled.body);
}

} // namespace flotsam
