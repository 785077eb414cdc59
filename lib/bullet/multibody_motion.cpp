#include "bullet/multibody_motion.hpp"

#include "bullet/convert.hpp"
#include "flotsam/core/contracts.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <cmath>

namespace flotsam {

namespace {

bool sleeps(const btMultiBodyLinkCollider* collider)
{
    return collider != nullptr && collider->getActivationState() == ISLAND_SLEEPING;
}

bool is_zero(const Wrench& wrench)
{
    return wrench.linear.isZero(0.0) && wrench.angular.isZero(0.0);
}

} // namespace

void MultibodyMotion::read(double dt, const Vec3d& gravity, bool is_gravity_in_forces)
{
    require(dt > 0.0 && std::isfinite(dt), "a step must be > 0 s and finite", dt);
    dt_ = dt;
    is_asleep_ = flotsam::is_asleep(*body_);
    applied_.resize(static_cast<std::size_t>(size()));
    kinematics_.update(*body_);
    mobility_.update(*body_, kinematics_);
    body_->forwardKinematics(rotations_, vectors_);

    accelerate();
    if (is_asleep_) unaided_.setZero(); // waking clears what Bullet has piled up
    left_out_ = is_asleep_ && is_gravity_in_forces ? gravity : Vec3d::Zero();
    if (is_asleep_ || !is_gravity_in_forces) add_gravity(gravity);
    predict();
}

void MultibodyMotion::accelerate()
{
    put_aside_.resize(static_cast<std::size_t>(body_->getNumLinks()));
    for (int k = 0; k < body_->getNumLinks(); ++k) {
        btMultibodyLink& link = body_->getLink(k);
        put_aside_[static_cast<std::size_t>(k)] = {link.m_jointFeedback, link.m_absFrameTotVelocity,
                                                   link.m_absFrameLocVelocity};
        link.m_jointFeedback = nullptr;
    }
    // With dt 0 it leaves the velocities alone.
    body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, numbers_, vectors_, matrices_, false, false, false);
    for (int k = 0; k < body_->getNumLinks(); ++k) {
        btMultibodyLink& link = body_->getLink(k);
        const PutAside& before = put_aside_[static_cast<std::size_t>(k)];
        link.m_jointFeedback = before.feedback;
        link.m_absFrameTotVelocity = before.total_velocity;
        link.m_absFrameLocVelocity = before.joint_velocity;
    }
    unaided_.resize(kinematics_.dofs());
    for (int k = 0; k < kinematics_.dofs(); ++k)
        unaided_[k] = static_cast<double>(numbers_[body_->getNumDofs() + k]); // where Bullet's Runge-Kutta finds them
}

void MultibodyMotion::add_gravity(const Vec3d& gravity)
{
    predicted_.setZero(kinematics_.dofs());
    for (int link = 0; link < size(); ++link) {
        const LinkInertia inertia = inertia_of(*body_, link, pose(link));
        kinematics_.gather(link, {inertia.mass * gravity, Vec3d::Zero()}, predicted_);
    }
    mobility_.accelerate(predicted_);
    unaided_ += predicted_;
}

void MultibodyMotion::predict()
{
    const auto fastest = static_cast<double>(body_->getMaxCoordinateVelocity());
    now_.resize(kinematics_.dofs());
    for (int k = 0; k < kinematics_.dofs(); ++k) {
        now_[k] = static_cast<double>(body_->getVelocityVector()[k]);
        unaided_[k] = std::clamp(now_[k] + dt_ * unaided_[k], -fastest, fastest);
    }
    predicted_ = unaided_;
    if (is_asleep_) predicted_.setZero();
}

void MultibodyMotion::apply(std::span<const Wrench> impulses)
{
    require(dt_ > 0.0, "apply needs a read before it");
    require(impulses.size() == static_cast<std::size_t>(size()), "apply needs one impulse per link", impulses.size());
    const bool is_touched = !std::all_of(impulses.begin(), impulses.end(), is_zero);
    if (is_asleep_ && !is_touched) return;
    if (is_touched) wake();
    for (int link = 0; link < size(); ++link) {
        Wrench impulse = impulses[static_cast<std::size_t>(link)];
        if (is_asleep_) { // holds it where it slept, but for the impulses
            const Twist unaided = kinematics_.twist(link, unaided_);
            impulse += inertia_of(*body_, link, pose(link)) * Twist{-unaided.linear, -unaided.angular};
        }
        const Wrench force = impulse * (1.0 / dt_);
        add_force(link, force);
        applied_[static_cast<std::size_t>(link)] += force;
    }
    is_asleep_ = false;
}

void MultibodyMotion::withdraw()
{
    for (int link = 0; link < static_cast<int>(applied_.size()); ++link)
        add_force(link, applied_[static_cast<std::size_t>(link)] * -1.0);
    forget();
}

void MultibodyMotion::forget()
{
    std::fill(applied_.begin(), applied_.end(), Wrench{});
}

void MultibodyMotion::wake()
{
    if (is_asleep_) body_->clearForcesAndTorques();
    body_->wakeUp();
    if (body_->getBaseCollider() != nullptr) body_->getBaseCollider()->activate(true);
    for (int k = 0; k < body_->getNumLinks(); ++k)
        if (body_->getLinkCollider(k) != nullptr) body_->getLinkCollider(k)->activate(true);
    if (left_out_.isZero(0.0)) return;
    for (int link = 0; link < size(); ++link)
        add_force(link, {inertia_of(*body_, link, pose(link)).mass * left_out_, Vec3d::Zero()});
    left_out_.setZero();
}

void MultibodyMotion::add_force(int link, const Wrench& force)
{
    if (link == 0) {
        body_->addBaseForce(to_bullet(force.linear));
        body_->addBaseTorque(to_bullet(force.angular));
    } else {
        body_->addLinkForce(link - 1, to_bullet(force.linear));
        body_->addLinkTorque(link - 1, to_bullet(force.angular));
    }
}

bool is_asleep(const btMultiBody& body)
{
    if (sleeps(body.getBaseCollider())) return true;
    for (int k = 0; k < body.getNumLinks(); ++k)
        if (sleeps(body.getLinkCollider(k))) return true;
    return false;
}

} // namespace flotsam
