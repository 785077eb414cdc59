#include "bullet/bullet_bodies.hpp"

#include "bullet/convert.hpp"
#include "flotsam/core/contracts.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

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

int BulletBodies::add(btMultiBodyLinkCollider& link)
{
    Coupled coupled;
    coupled.link = &link;
    bodies_.push_back(coupled);
    if (articulation_of(*link.m_multiBody) == nullptr) {
        articulations_.push_back({MultibodyMotion(*link.m_multiBody), 0, false, {}});
        articulations_.back().impulses.resize(static_cast<std::size_t>(articulations_.back().motion.size()));
    }
    return static_cast<int>(bodies_.size()) - 1;
}

void BulletBodies::remove(int number)
{
    require(number >= 0 && number < static_cast<int>(bodies_.size()), "no body has this number", number);
    const btMultiBodyLinkCollider* link = bodies_[static_cast<std::size_t>(number)].link;
    bodies_[static_cast<std::size_t>(number)] = {};
    if (link == nullptr) return;
    const auto is_of_the_same = [&](const Coupled& other) {
        return other.link != nullptr && other.link->m_multiBody == link->m_multiBody;
    };
    if (std::any_of(bodies_.begin(), bodies_.end(), is_of_the_same)) return;
    std::erase_if(articulations_, [&](const Articulation& a) { return &a.motion.body() == link->m_multiBody; });
}

int BulletBodies::number_of(const btCollisionObject& object) const
{
    const auto found = std::find_if(bodies_.begin(), bodies_.end(), [&](const Coupled& coupled) {
        return coupled.body == &object || coupled.link == &object;
    });
    return found == bodies_.end() ? -1 : static_cast<int>(found - bodies_.begin());
}

btRigidBody& BulletBodies::body(int number) const
{
    require(number >= 0 && number < static_cast<int>(bodies_.size()) &&
                bodies_[static_cast<std::size_t>(number)].body != nullptr,
            "a body's number must be one that add returned for a rigid body and that was not removed", number);
    return *bodies_[static_cast<std::size_t>(number)].body;
}

BulletBodies::Articulation* BulletBodies::articulation_of(const btMultiBody& body)
{
    const auto found = std::find_if(articulations_.begin(), articulations_.end(),
                                    [&](const Articulation& a) { return &a.motion.body() == &body; });
    return found == articulations_.end() ? nullptr : &*found;
}

void BulletBodies::begin(double seconds, bool in_tick)
{
    require(seconds > 0.0 && std::isfinite(seconds), "a step must be > 0 s and finite", seconds);
    require_in_world();
    seconds_ = seconds;
    is_in_tick_ = in_tick;
    elapsed_ = 0.0;
    is_single_ = false;
    motion_.clear();
    numbers_.reset(world_);
    start_.clear();
    end_.clear();
    for (Articulation& articulation : articulations_) begin_articulation(articulation);
    for (Coupled& coupled : bodies_) {
        begin_body(coupled);
        if (coupled.link != nullptr) continue;
        coupled.entity = add_entity(coupled.start, coupled.end, dense(coupled.mobility));
        if (coupled.body != nullptr) numbers_.set(*coupled.body, coupled.entity, coupled.is_dynamic);
    }
    collect_rows();
    impulses_.resize(motion_.bodies());
    answers_.resize(motion_.bodies());
    twists_.resize(motion_.bodies());
}

/// A body that was taken out would go on being pushed where it is not.
void BulletBodies::require_in_world() const
{
    const btCollisionObjectArray& objects = world_.getCollisionObjectArray();
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const btCollisionObject* object = bodies_[k].body;
        if (object == nullptr) object = bodies_[k].link;
        if (object == nullptr) continue; // removed
        const int index = object->getWorldArrayIndex();
        if (index < 0 || index >= objects.size() || objects[index] != object)
            require(false,
                    "body " + std::to_string(k) + " must be in the Bullet world until it is removed from its coupling");
    }
}

int BulletBodies::add_entity(const Twist& start, const Twist& end, const Mat6d& mobility)
{
    start_.push_back(start);
    end_.push_back(end);
    return motion_.add_body(end, mobility);
}

void BulletBodies::begin_articulation(Articulation& articulation)
{
    MultibodyMotion& motion = articulation.motion;
    motion.read(seconds_, from_bullet(world_.getGravity()), is_in_tick_);
    const int links = motion.size();
    articulation.entity = static_cast<int>(start_.size());
    Eigen::MatrixXd mobility(6 * links, 6 * links);
    for (int to = 0; to < links; ++to)
        for (int from = 0; from < links; ++from)
            mobility.block<6, 6>(6 * to, 6 * from) = motion.mobility().block(to, from);
    for (int link = 0; link < links; ++link) {
        start_.push_back(motion.is_asleep() ? Twist{} : motion.twist(link));
        end_.push_back(motion.predicted(link));
        const btMultiBody& body = motion.body();
        const btMultiBodyLinkCollider* collider =
            link == 0 ? body.getBaseCollider() : body.getLink(link - 1).m_collider;
        if (collider != nullptr) numbers_.set(*collider, articulation.entity + link, motion.mobility().responds(link));
    }
    motion_.add_bodies(std::span(end_).subspan(static_cast<std::size_t>(articulation.entity)), mobility);
}

void BulletBodies::begin_link(Coupled& coupled)
{
    const Articulation& articulation = *articulation_of(*coupled.link->m_multiBody);
    const int link = coupled.link->m_link + 1;
    coupled.entity = articulation.entity + link;
    coupled.pose = articulation.motion.pose(link);
    coupled.is_dynamic = articulation.motion.mobility().responds(link);
    coupled.start = coupled.twist = start_[static_cast<std::size_t>(coupled.entity)];
    coupled.end = end_[static_cast<std::size_t>(coupled.entity)];
}

/// Bullet sets joints and contacts up when it has moved kinematic bodies to where they end, which it has within a tick.
/// Looked at from where they start, a joint to one that moves would be short of what its error adds: erp of its speed.
void BulletBodies::collect_rows()
{
    put_aside_.clear();
    for (const Coupled& coupled : bodies_) {
        if (is_in_tick_ || coupled.body == nullptr || !coupled.was_kinematic) continue;
        put_aside_.emplace_back(coupled.body, coupled.body->getWorldTransform());
        coupled.body->setWorldTransform(coupled.kinematic.end_pose(*coupled.body, seconds_));
    }
    collector_.collect(world_, seconds_, numbers_, motion_, [&](btRigidBody& body) { return add_uncoupled(body); });
    add_multibody_rows();
    for (const auto& [body, pose] : put_aside_) body->setWorldTransform(pose);
}

/// Motors, limits and other constraints of multibodies.
void BulletBodies::add_multibody_rows()
{
    auto* world = articulations_.empty() ? nullptr : dynamic_cast<btMultiBodyDynamicsWorld*>(&world_);
    if (world == nullptr) return;
    rows_scratch_.clear();
    for (int k = 0; k < world->getNumMultiBodyConstraints(); ++k) {
        btMultiBodyConstraint& constraint = *world->getMultiBodyConstraint(k);
        const auto is_read = [&](btMultiBody* body) { return body == nullptr || articulation_of(*body) != nullptr; };
        if (!is_read(constraint.getMultiBodyA()) || !is_read(constraint.getMultiBodyB())) continue;
        multibody_rows_.append(constraint, seconds_, world_.getSolverInfo(), rows_scratch_);
    }
    for (const MultibodyRow& from : rows_scratch_) {
        ConstraintRow row;
        row.a = entity_of(from.a);
        row.b = entity_of(from.b);
        row.jacobian_a = from.jacobian_a;
        row.jacobian_b = from.jacobian_b;
        row.target = from.target;
        row.cfm = from.cfm;
        row.lower = from.lower;
        row.upper = from.upper;
        motion_.add_row(row);
    }
}

int BulletBodies::entity_of(const RowEnd& end)
{
    if (end.multibody != nullptr) return articulation_of(*end.multibody)->entity + end.link;
    if (end.body == nullptr || end.body->isStaticObject()) return -1;
    if (numbers_.of(*end.body) == MotionNumbers::kNone)
        numbers_.set(*end.body, add_uncoupled(*end.body), !end.body->isKinematicObject());
    return numbers_.of(*end.body);
}

void BulletBodies::begin_body(Coupled& coupled)
{
    coupled.mobility = {};
    coupled.given = {};
    coupled.start = coupled.end = coupled.unaided = {};
    coupled.is_dynamic = coupled.is_asleep = false;
    if (coupled.link != nullptr) begin_link(coupled);
    if (coupled.body == nullptr) return;
    btRigidBody& body = *coupled.body;
    const bool is_kinematic = body.isKinematicObject();
    if (is_kinematic && !coupled.was_kinematic) {
        coupled.kinematic = {};
        if (!is_in_tick_) coupled.kinematic.start(body);
    }
    coupled.was_kinematic = is_kinematic;
    if (is_kinematic) {
        coupled.start =
            is_in_tick_ ? coupled.kinematic.plan_in_tick(body, seconds_) : coupled.kinematic.plan(body, seconds_);
        coupled.pose = is_in_tick_ ? coupled.kinematic.pose_in_tick() : KinematicMotion::start_pose(body);
        coupled.end = coupled.unaided = coupled.start;
    } else {
        coupled.pose = from_bullet(body.getWorldTransform());
        if (!body.isStaticObject() && body.getActivationState() != DISABLE_SIMULATION) begin_dynamic(coupled);
    }
    coupled.twist = coupled.start;
}

void BulletBodies::begin_dynamic(Coupled& coupled)
{
    btRigidBody& body = *coupled.body;
    coupled.is_dynamic = true;
    coupled.is_asleep = !body.isActive();
    const FreeMotion motion = free_motion_of(body);
    coupled.mobility = mobility_of(body);
    coupled.unaided = motion.end;
    if (coupled.is_asleep) return;
    const Vec3d turned = motion.end.angular - motion.damped.angular;
    const Vec3d leak = turned - coupled.mobility.held * turned; // about locked axes; exactly 0 without any
    coupled.start = twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
    coupled.end = {motion.end.linear, motion.end.angular - leak};
}

int BulletBodies::add_uncoupled(btRigidBody& body)
{
    Coupled other;
    other.body = &body;
    if (body.isKinematicObject())
        other.start = other.end = twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
    else if (body.getActivationState() != DISABLE_SIMULATION)
        begin_dynamic(other);
    return add_entity(other.start, other.end, dense(other.mobility));
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
    if (part != 1.0 || elapsed_ > 0.0) {
        for (std::size_t k = 0; k < motion_.bodies(); ++k)
            motion_.set_free(k, sum(elapsed_ > 0.0 ? twists_[k] : start_[k], between(start_[k], end_[k], part)));
        motion_.scale_bounds(part);
    }
    guess_impulses(dt);
    motion_.solve(impulses_, 0.1 * revision_tolerance());
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const Coupled& coupled = bodies_[k];
        states[k] = {coupled.pose, motion_.predicted()[static_cast<std::size_t>(coupled.entity)], coupled.is_dynamic,
                     coupled.twist};
    }
}

/// Which joints and contacts will hold is guessed with the forces of the last Bullet step.
void BulletBodies::guess_impulses(double dt)
{
    std::fill(impulses_.begin(), impulses_.end(), Wrench{});
    for (const Coupled& coupled : bodies_)
        impulses_[static_cast<std::size_t>(coupled.entity)] = coupled.last_given * dt;
}

void BulletBodies::spread(std::span<const Wrench> impulses) const
{
    std::fill(impulses_.begin(), impulses_.end(), Wrench{});
    for (std::size_t k = 0; k < bodies_.size(); ++k)
        impulses_[static_cast<std::size_t>(bodies_[k].entity)] = impulses[k];
}

void BulletBodies::respond(std::span<const Wrench> impulses, std::span<Twist> twists) const
{
    FLOTSAM_ASSERT(impulses.size() == bodies_.size() && twists.size() == bodies_.size(), "one entry per body");
    spread(impulses);
    motion_.respond(impulses_, answers_);
    for (std::size_t k = 0; k < bodies_.size(); ++k) twists[k] = answers_[static_cast<std::size_t>(bodies_[k].entity)];
}

bool BulletBodies::own_mobility(std::span<Mat6d> blocks) const
{
    for (std::size_t k = 0; k < bodies_.size(); ++k)
        blocks[k] = motion_.own_mobility(static_cast<std::size_t>(bodies_[k].entity));
    return true;
}

/// What a contact may be wrong by without anybody seeing it, of the velocity that gravity gives in a step [m/s].
double BulletBodies::revision_tolerance() const
{
    return 1e-2 * std::max(1e-3, static_cast<double>(world_.getGravity().length())) * dt_;
}

bool BulletBodies::revise(std::span<const Wrench> impulses, std::span<BodyState> states)
{
    spread(impulses);
    if (motion_.holds(impulses_, revision_tolerance())) return false;
    motion_.solve(impulses_, 0.1 * revision_tolerance());
    for (std::size_t k = 0; k < bodies_.size(); ++k)
        states[k].predicted = motion_.predicted()[static_cast<std::size_t>(bodies_[k].entity)];
    return true;
}

void BulletBodies::apply(std::span<const Wrench> impulses)
{
    require(is_open() || bodies_.empty(), "apply needs a read before it");
    require(impulses.size() == bodies_.size(), "apply needs one impulse per body", impulses.size());
    spread(impulses);
    if (!motion_.holds(impulses_, revision_tolerance())) motion_.solve(impulses_, 0.1 * revision_tolerance());
    motion_.respond(impulses_, answers_);
    for (std::size_t k = 0; k < motion_.bodies(); ++k) twists_[k] = sum(motion_.predicted()[k], answers_[k]);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        Coupled& coupled = bodies_[k];
        coupled.given += impulses[k];
        coupled.twist = twists_[static_cast<std::size_t>(coupled.entity)];
        coupled.pose = moved(coupled.pose, coupled.twist, dt_);
    }
    elapsed_ += dt_;
    if (is_single_) finish();
}

std::optional<Vec3d> BulletBodies::gravity() const
{
    return from_bullet(world_.getGravity());
}

void BulletBodies::finish()
{
    for (Coupled& coupled : bodies_) {
        coupled.last_given = coupled.given * (1.0 / seconds_);
        coupled.force = coupled.torque = Vec3d::Zero();
        if (coupled.was_kinematic) coupled.kinematic.reached(coupled.pose);
        const bool is_touched = !is_zero(coupled.given.linear, coupled.given.angular);
        if (coupled.body != nullptr && coupled.is_dynamic && is_touched) push_body(coupled);
    }
    push_articulations();
    seconds_ = 0.0;
}

void BulletBodies::push_body(Coupled& coupled)
{
    btRigidBody& body = *coupled.body;
    body.activate(true);
    const Twist aided = sum(coupled.end, coupled.mobility * coupled.given);
    coupled.force = static_cast<double>(body.getMass()) / seconds_ * (aided.linear - coupled.unaided.linear);
    if (!turn(coupled, aided.angular)) {
        const Mat3d axes = from_bullet(body.getWorldTransform().getBasis());
        const Vec3d inertia = from_bullet(body.getLocalInertia()); // 0 where the body never turns
        coupled.torque =
            axes * inertia.asDiagonal() * axes.transpose() * (aided.angular - coupled.unaided.angular) / seconds_;
    }
    add_forces(body, coupled.force, coupled.torque);
}

void BulletBodies::push_articulations()
{
    for (Articulation& articulation : articulations_) {
        std::fill(articulation.impulses.begin(), articulation.impulses.end(), Wrench{});
        articulation.is_pushed = false;
        for (const Coupled& coupled : bodies_) {
            if (coupled.link == nullptr || coupled.link->m_multiBody != &articulation.motion.body()) continue;
            articulation.impulses[static_cast<std::size_t>(coupled.link->m_link + 1)] = coupled.given;
            const bool is_touched = !is_zero(coupled.given.linear, coupled.given.angular);
            articulation.is_pushed = articulation.is_pushed || is_touched;
        }
        if (articulation.is_pushed) articulation.motion.apply(articulation.impulses);
    }
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
    Vec3d missing = end - free_motion_of(body).end.angular;
    for (int k = 0; k < kSteps && missing.norm() > 1e-15 * (1.0 + end.norm()); ++k) {
        body.setAngularVelocity(body.getAngularVelocity() + to_bullet(missing / kept));
        missing = end - free_motion_of(body).end.angular;
    }
    if (missing.norm() <= 1e-6 * (1.0 + end.norm())) return true;
    body.setAngularVelocity(before);
    return false;
}

FreeMotion BulletBodies::free_motion_of(btRigidBody& body) const
{
    return free_motion(body, seconds_, world_.getSolverInfo().m_maxGyroscopicForce, is_in_tick_);
}

void BulletBodies::take_back_forces()
{
    for (Coupled& coupled : bodies_) {
        if (coupled.body == nullptr || is_zero(coupled.force, coupled.torque)) continue;
        add_forces(*coupled.body, -coupled.force, -coupled.torque);
        coupled.force = coupled.torque = Vec3d::Zero();
    }
    for (Articulation& articulation : articulations_)
        if (std::exchange(articulation.is_pushed, false)) articulation.motion.withdraw();
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
    for (Articulation& articulation : articulations_)
        if (std::exchange(articulation.is_pushed, false)) articulation.motion.forget();
}

} // namespace flotsam
