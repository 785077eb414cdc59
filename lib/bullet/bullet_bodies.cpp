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

Twist sum(const Twist& a, const Twist& b)
{
    return {a.linear + b.linear, a.angular + b.angular};
}

Twist between(const Twist& from, const Twist& to, double part)
{
    return {part * (to.linear - from.linear), part * (to.angular - from.angular)};
}

Mat6d dense(const Mobility& mobility)
{
    Mat6d matrix = Mat6d::Zero();
    matrix.topLeftCorner<3, 3>() = mobility.linear.asDiagonal();
    matrix.bottomRightCorner<3, 3>() = mobility.angular;
    return matrix;
}

/// Adds forces with the body's factors put aside for the moment: they are in the forces already, and holding a locked
/// axis takes a torque about it.
void add_forces(btRigidBody& body, const Vec3d& force, const Vec3d& torque)
{
    const btVector3 linear_factor = body.getLinearFactor(), angular_factor = body.getAngularFactor();
    body.setLinearFactor(btVector3(1, 1, 1));
    body.setAngularFactor(btVector3(1, 1, 1));
    body.applyCentralForce(to_bullet(force));
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

void BulletBodies::remove(int number)
{
    static_cast<void>(body(number));
    bodies_[static_cast<std::size_t>(number)] = {};
}

int BulletBodies::number_of(const btRigidBody& body) const
{
    const auto found =
        std::find_if(bodies_.begin(), bodies_.end(), [&](const Coupled& coupled) { return coupled.body == &body; });
    return found == bodies_.end() ? -1 : static_cast<int>(found - bodies_.begin());
}

btRigidBody& BulletBodies::body(int number) const
{
    require(number >= 0 && number < static_cast<int>(bodies_.size()) &&
                bodies_[static_cast<std::size_t>(number)].body != nullptr,
            "a body's number must be one that add returned and that was not removed", number);
    return *bodies_[static_cast<std::size_t>(number)].body;
}

void BulletBodies::begin(double seconds, bool in_tick)
{
    require(seconds > 0.0 && std::isfinite(seconds), "a step must be > 0 s and finite", seconds);
    seconds_ = seconds;
    is_in_tick_ = in_tick;
    elapsed_ = 0.0;
    is_single_ = false;
    motion_.clear();
    numbers_.reset(world_);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        Coupled& coupled = bodies_[k];
        begin_body(coupled, seconds, in_tick);
        motion_.add_body(coupled.end, dense(coupled.mobility));
        if (coupled.body != nullptr) numbers_.set(*coupled.body, static_cast<int>(k), coupled.is_dynamic);
    }
    uncoupled_start_.clear();
    uncoupled_end_.clear();
    collector_.collect(world_, seconds, numbers_, motion_,
                       [&](btRigidBody& body) { return add_uncoupled(body, in_tick); });
    impulses_.resize(motion_.bodies());
    answers_.resize(motion_.bodies());
    twists_.resize(motion_.bodies());
}

void BulletBodies::begin_body(Coupled& coupled, double seconds, bool in_tick)
{
    coupled.mobility = {};
    coupled.given = {};
    coupled.start = coupled.end = coupled.unaided = {};
    coupled.is_dynamic = coupled.is_asleep = false;
    if (coupled.body == nullptr) return;
    btRigidBody& body = *coupled.body;
    const bool is_kinematic = body.isKinematicObject();
    if (is_kinematic && !coupled.was_kinematic) {
        coupled.kinematic = {};
        if (!in_tick) coupled.kinematic.start(body);
    }
    coupled.was_kinematic = is_kinematic;
    if (is_kinematic) {
        coupled.start = in_tick ? coupled.kinematic.plan_in_tick(body, seconds) : coupled.kinematic.plan(body, seconds);
        coupled.pose = in_tick ? coupled.kinematic.pose_in_tick() : KinematicMotion::start_pose(body);
        coupled.end = coupled.unaided = coupled.start;
    } else {
        coupled.pose = from_bullet(body.getWorldTransform());
        if (!body.isStaticObject() && body.getActivationState() != DISABLE_SIMULATION)
            begin_dynamic(coupled, seconds, in_tick);
    }
    coupled.twist = coupled.start;
}

void BulletBodies::begin_dynamic(Coupled& coupled, double seconds, bool in_tick)
{
    btRigidBody& body = *coupled.body;
    coupled.is_dynamic = true;
    coupled.is_asleep = !body.isActive();
    const FreeMotion motion = free_motion(body, seconds, world_.getSolverInfo().m_maxGyroscopicForce, in_tick);
    coupled.mobility = mobility_of(body);
    coupled.unaided = motion.end;
    if (coupled.is_asleep) return;
    const Vec3d turned = motion.end.angular - motion.damped.angular;
    const Vec3d leak = turned - coupled.mobility.held * turned; // about locked axes; exactly 0 without any
    coupled.start = twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
    coupled.end = {motion.end.linear, motion.end.angular - leak};
}

int BulletBodies::add_uncoupled(btRigidBody& body, bool in_tick)
{
    Coupled other;
    other.body = &body;
    if (body.isKinematicObject())
        other.start = other.end = twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
    else if (body.getActivationState() != DISABLE_SIMULATION)
        begin_dynamic(other, seconds_, in_tick);
    uncoupled_start_.push_back(other.start);
    uncoupled_end_.push_back(other.end);
    return motion_.add_body(other.end, dense(other.mobility));
}

void BulletBodies::read(double dt, std::span<BodyState> states)
{
    require(dt > 0.0 && std::isfinite(dt), "a step must be > 0 s and finite", dt);
    require(states.size() == bodies_.size(), "read needs one state per body", states.size());
    if (!is_open() || is_single_) {
        begin(dt, false);
        is_single_ = true;
    }
    dt_ = dt;
    const double part = dt / seconds_;
    const bool is_whole = part == 1.0 && elapsed_ == 0.0;
    if (!is_whole) {
        for (std::size_t k = 0; k < bodies_.size(); ++k)
            motion_.set_free(k, sum(bodies_[k].twist, between(bodies_[k].start, bodies_[k].end, part)));
        for (std::size_t k = bodies_.size(); k < motion_.bodies(); ++k) {
            const std::size_t other = k - bodies_.size();
            motion_.set_free(k, sum(elapsed_ > 0.0 ? twists_[k] : uncoupled_start_[other],
                                    between(uncoupled_start_[other], uncoupled_end_[other], part)));
        }
        motion_.scale_bounds(part);
    }
    guess_impulses(dt);
    motion_.solve(impulses_, 0.1 * revision_tolerance());
    for (std::size_t k = 0; k < bodies_.size(); ++k)
        states[k] = {bodies_[k].pose, motion_.predicted()[k], bodies_[k].is_dynamic, bodies_[k].twist};
}

/// Which joints and contacts will hold is guessed with the forces of the last Bullet step.
void BulletBodies::guess_impulses(double dt)
{
    std::fill(impulses_.begin(), impulses_.end(), Wrench{});
    for (std::size_t k = 0; k < bodies_.size(); ++k) impulses_[k] = bodies_[k].last_given * dt;
}

void BulletBodies::respond(std::span<const Wrench> impulses, std::span<Twist> twists) const
{
    FLOTSAM_ASSERT(impulses.size() == bodies_.size() && twists.size() == bodies_.size(), "one entry per body");
    std::copy(impulses.begin(), impulses.end(), impulses_.begin());
    std::fill(impulses_.begin() + static_cast<std::ptrdiff_t>(bodies_.size()), impulses_.end(), Wrench{});
    motion_.respond(impulses_, answers_);
    std::copy_n(answers_.begin(), bodies_.size(), twists.begin());
}

bool BulletBodies::own_mobility(std::span<Mat6d> blocks) const
{
    for (std::size_t k = 0; k < bodies_.size(); ++k) blocks[k] = motion_.own_mobility(k);
    return true;
}

/// What a contact may be wrong by without anybody seeing it, of the velocity that gravity gives in a step [m/s].
double BulletBodies::revision_tolerance() const
{
    return 1e-2 * std::max(1e-3, static_cast<double>(world_.getGravity().length())) * dt_;
}

bool BulletBodies::revise(std::span<const Wrench> impulses, std::span<BodyState> states)
{
    std::copy(impulses.begin(), impulses.end(), impulses_.begin());
    std::fill(impulses_.begin() + static_cast<std::ptrdiff_t>(bodies_.size()), impulses_.end(), Wrench{});
    if (motion_.holds(impulses_, revision_tolerance())) return false;
    motion_.solve(impulses_, 0.1 * revision_tolerance());
    for (std::size_t k = 0; k < bodies_.size(); ++k) states[k].predicted = motion_.predicted()[k];
    return true;
}

void BulletBodies::apply(std::span<const Wrench> impulses)
{
    require(is_open() || bodies_.empty(), "apply needs a read before it");
    require(impulses.size() == bodies_.size(), "apply needs one impulse per body", impulses.size());
    std::copy(impulses.begin(), impulses.end(), impulses_.begin());
    std::fill(impulses_.begin() + static_cast<std::ptrdiff_t>(bodies_.size()), impulses_.end(), Wrench{});
    if (!motion_.holds(impulses_, revision_tolerance())) motion_.solve(impulses_, 0.1 * revision_tolerance());
    motion_.respond(impulses_, answers_);
    for (std::size_t k = 0; k < motion_.bodies(); ++k) twists_[k] = sum(motion_.predicted()[k], answers_[k]);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        Coupled& coupled = bodies_[k];
        coupled.given += impulses[k];
        coupled.twist = twists_[k];
        coupled.pose = moved(coupled.pose, coupled.twist, dt_);
    }
    elapsed_ += dt_;
    if (is_single_) finish();
}

void BulletBodies::finish()
{
    for (Coupled& coupled : bodies_) {
        coupled.last_given = coupled.given * (1.0 / seconds_);
        coupled.force = coupled.torque = Vec3d::Zero();
        const Wrench& given = coupled.given;
        if (coupled.was_kinematic) coupled.kinematic.reached(coupled.pose);
        if (!coupled.is_dynamic || is_zero(given.linear, given.angular)) continue;
        btRigidBody& body = *coupled.body;
        body.activate(true);
        const Twist aided = sum(coupled.end, coupled.mobility * given);
        coupled.force = static_cast<double>(body.getMass()) / seconds_ * (aided.linear - coupled.unaided.linear);
        if (!turn(coupled, aided.angular)) {
            const Mat3d axes = from_bullet(body.getWorldTransform().getBasis());
            const Vec3d inertia = from_bullet(body.getLocalInertia()); // 0 where the body never turns
            coupled.torque =
                axes * inertia.asDiagonal() * axes.transpose() * (aided.angular - coupled.unaided.angular) / seconds_;
        }
        add_forces(body, coupled.force, coupled.torque);
    }
    seconds_ = 0.0;
}

/// Gives the body the angular velocity from which Bullet's step takes it to `end`. A torque would do the same, but
/// Bullet 3.24's friction rows leave torques out (setupFrictionConstraint), and what lies on something would creep by
/// what they turn it. False: damping is too strong, or not linear, for that.
bool BulletBodies::turn(const Coupled& coupled, const Vec3d& end) const
{
    constexpr int kSteps = 8; // gyroscopic terms make it slightly nonlinear
    btRigidBody& body = *coupled.body;
    const double kept = std::pow(1.0 - static_cast<double>(body.getAngularDamping()), seconds_);
    if (!(kept > 0.1)) return false;
    const btVector3 before = body.getAngularVelocity();
    for (int k = 0; k < kSteps; ++k) {
        const FreeMotion motion = free_motion(body, seconds_, world_.getSolverInfo().m_maxGyroscopicForce, is_in_tick_);
        const Vec3d missing = end - motion.end.angular;
        if (!(missing.norm() > 1e-15 * (1.0 + end.norm()))) break;
        body.setAngularVelocity(body.getAngularVelocity() + to_bullet(missing / kept));
    }
    const FreeMotion motion = free_motion(body, seconds_, world_.getSolverInfo().m_maxGyroscopicForce, is_in_tick_);
    if ((end - motion.end.angular).norm() <= 1e-6 * (1.0 + end.norm())) return true;
    body.setAngularVelocity(before);
    return false;
}

void BulletBodies::take_back_forces()
{
    for (Coupled& coupled : bodies_) {
        if (coupled.body == nullptr || is_zero(coupled.force, coupled.torque)) continue;
        add_forces(*coupled.body, -coupled.force, -coupled.torque);
        coupled.force = coupled.torque = Vec3d::Zero();
    }
}

double BulletBodies::disagreement() const
{
    double most = 0.0;
    for (const Coupled& coupled : bodies_) {
        if (coupled.body == nullptr || !coupled.is_dynamic) continue;
        most = std::max(most, (from_bullet(coupled.body->getLinearVelocity()) - coupled.twist.linear).norm());
    }
    return most;
}

void BulletBodies::before_bullet_step(double dt)
{
    for (Coupled& coupled : bodies_)
        if (coupled.body != nullptr && coupled.was_kinematic && coupled.body->isKinematicObject())
            coupled.kinematic.move(*coupled.body, dt);
}

void BulletBodies::after_bullet_step()
{
    for (Coupled& coupled : bodies_)
        if (coupled.body != nullptr && coupled.was_kinematic) coupled.kinematic.finish(*coupled.body);
}

} // namespace flotsam
