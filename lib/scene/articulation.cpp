#include "scene/articulation.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>

#include <algorithm>
#include <cmath>

namespace flotsam::scene {
namespace {

using Type = SceneJoint::Type;

/// In 2-D a ball turns about y.
bool turns_about_axis(const SceneJoint& joint)
{
    return joint.type != Type::slider && !joint.axis.isZero(0.0);
}

Vec3d velocity_at(const SceneBody& body, const Pose& start, const Vec3d& point)
{
    return body.velocity + body.angular_velocity.cross(point - start.position);
}

/// That Bullet's last step put on a body, about the world's origin [N s], [N m s].
Wrench contact_impulse(const btCollisionObject& body, btDynamicsWorld& world)
{
    Wrench sum;
    btDispatcher& dispatcher = *world.getDispatcher();
    for (int k = 0; k < dispatcher.getNumManifolds(); ++k) {
        const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(k);
        if (manifold.getBody0() != &body && manifold.getBody1() != &body) continue;
        const btScalar side = manifold.getBody0() == &body ? 1 : -1;
        for (int contact = 0; contact < manifold.getNumContacts(); ++contact) {
            const btManifoldPoint& point = manifold.getContactPoint(contact);
            const btVector3 impulse = side * (point.m_appliedImpulse * point.m_normalWorldOnB +
                                              point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                                              point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2);
            sum += Wrench{from_bullet(impulse), Vec3d::Zero()}.seen_at(from_bullet(point.getPositionWorldOnB()));
        }
    }
    return sum;
}

} // namespace

Articulation::Articulation(const SceneFile& scene, const SceneArticulation& articulation, const PreparedScene& prepared,
                           const std::vector<btCollisionShape*>& shapes, btMultiBodyDynamicsWorld& world)
    : world_(world)
{
    add_base(scene, articulation, prepared);
    for (const std::size_t joint : articulation.joints) add_link(scene, joint, prepared);
    body_->finalizeMultiDof();
    body_->setLinearDamping(0);
    body_->setAngularDamping(0);
    body_->setMaxCoordinateVelocity(to_scalar(1e9)); // Bullet's own holds links at 100 m/s or rad/s
    for (Link& link : links_) {
        link.collider = std::make_unique<btMultiBodyLinkCollider>(body_.get(), link.number);
        link.collider->setCollisionShape(shapes[link.body]);
        link.collider->setFriction(to_scalar(scene.bodies[link.body].friction));
        link.collider->setActivationState(DISABLE_DEACTIVATION); // a floating body never rests for good
        if (link.number < 0)
            body_->setBaseCollider(link.collider.get());
        else
            body_->getLink(link.number).m_collider = link.collider.get();
    }
    start_moving(scene);
    world_.addMultiBody(body_.get());
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> positions;
    body_->forwardKinematics(rotations, positions);
    body_->updateCollisionObjectWorldTransforms(rotations, positions);
    for (Link& link : links_) {
        world_.addCollisionObject(link.collider.get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
        if (link.joint) add_drives(link);
    }
    update();
}

Articulation::~Articulation()
{
    for (const Link& link : links_) {
        if (link.motor) world_.removeMultiBodyConstraint(link.motor.get());
        if (link.limit) world_.removeMultiBodyConstraint(link.limit.get());
        world_.removeCollisionObject(link.collider.get());
    }
    world_.removeMultiBody(body_.get());
}

std::optional<std::size_t> Articulation::link_of(std::optional<std::size_t> body) const
{
    const auto found = std::find_if(links_.begin(), links_.end(), [&](const Link& link) { return link.body == body; });
    if (found == links_.end()) return {};
    return static_cast<std::size_t>(found - links_.begin());
}

void Articulation::add_base(const SceneFile& scene, const SceneArticulation& articulation,
                            const PreparedScene& prepared)
{
    const auto joints = static_cast<int>(articulation.joints.size());
    const std::optional<std::size_t> base = scene.joints[articulation.joints.front()].b;
    if (!base) {
        body_ = std::make_unique<btMultiBody>(joints, 0, btVector3(1, 1, 1), true, false);
        return;
    }
    const PreparedBody& body = prepared.bodies[*base];
    body_ = std::make_unique<btMultiBody>(joints, to_scalar(body.mass), to_bullet(body.inertia), false, false);
    body_->setBaseWorldTransform(to_bullet(body.start));
    links_.emplace_back().body = *base;
}

void Articulation::add_link(const SceneFile& scene, std::size_t joint, const PreparedScene& prepared)
{
    const SceneJoint& of = scene.joints[joint];
    Link link;
    link.parent = link_of(of.b);
    const Pose from = link.parent ? prepared.bodies[*of.b].start : Pose();
    const int parent_number = link.parent ? links_[*link.parent].number : -1;
    link.body = of.a;
    link.number = static_cast<int>(links_.size()) - (body_->hasFixedBase() ? 0 : 1);
    link.joint = joint;
    link.of = of;
    const PreparedBody& body = prepared.bodies[of.a];
    const Quatd to_link = body.start.orientation.conjugate();
    const btQuaternion turn = to_bullet(to_link * from.orientation);
    const btVector3 axis = to_bullet(to_link * of.axis), to_pivot = to_bullet(from.to_body(of.point)),
                    to_center = to_bullet(to_link * (body.start.position - of.point)),
                    inertia = to_bullet(body.inertia);
    const btScalar mass = to_scalar(body.mass);
    if (of.type == Type::slider)
        body_->setupPrismatic(link.number, mass, inertia, parent_number, turn, axis, to_pivot, to_center, true);
    else if (turns_about_axis(of))
        body_->setupRevolute(link.number, mass, inertia, parent_number, turn, axis, to_pivot, to_center, true);
    else
        body_->setupSpherical(link.number, mass, inertia, parent_number, turn, to_pivot, to_center, true);
    links_.push_back(std::move(link));
}

void Articulation::add_drives(Link& link)
{
    if (link.of.limits) {
        link.limit = std::make_unique<btMultiBodyJointLimitConstraint>(
            body_.get(), link.number, to_scalar(link.of.limits->low), to_scalar(link.of.limits->high));
        world_.addMultiBodyConstraint(link.limit.get());
    }
    if (!link.of.motor) return;
    link.motor = std::make_unique<btMultiBodyJointMotor>(body_.get(), link.number, to_scalar(link.of.motor->velocity),
                                                         btScalar(0));
    world_.addMultiBodyConstraint(link.motor.get());
}

void Articulation::start_moving(const SceneFile& scene)
{
    kinematics_.update(*body_);
    for (const Link& link : links_) {
        const SceneBody& a = scene.bodies[link.body];
        if (!link.joint) {
            body_->setBaseVel(to_bullet(a.velocity));
            body_->setBaseOmega(to_bullet(a.angular_velocity));
            continue;
        }
        Vec3d spin = a.angular_velocity, velocity = velocity_at(a, kinematics_.pose(link.number + 1), link.of.point);
        if (link.parent) {
            const Link& parent = links_[*link.parent];
            const SceneBody& b = scene.bodies[parent.body];
            spin -= b.angular_velocity;
            velocity -= velocity_at(b, kinematics_.pose(parent.number + 1), link.of.point);
        }
        if (link.of.type == Type::slider) {
            body_->setJointVel(link.number, to_scalar(link.of.axis.dot(velocity)));
        } else if (turns_about_axis(link.of)) {
            body_->setJointVel(link.number, to_scalar(link.of.axis.dot(spin)));
        } else {
            const Vec3d in_link = kinematics_.pose(link.number + 1).orientation.conjugate() * spin;
            body_->setJointVelMultiDof(link.number, to_bullet(in_link).m_floats);
        }
    }
}

Twist Articulation::twist(std::size_t link) const
{
    return kinematics_.twist(links_[link].number + 1, velocity_);
}

void Articulation::begin_step(double dt)
{
    for (Link& link : links_) {
        const Pose& pose = kinematics_.pose(link.number + 1);
        link.before = momentum(link);
        link.center = link.pivot = pose.position;
        if (link.joint) link.pivot -= pose.orientation * from_bullet(body_->getLink(link.number).m_dVector);
        if (link.motor) link.motor->setMaxAppliedImpulse(to_scalar(link.of.motor->strength * dt));
    }
}

void Articulation::end_step(const FluidWorld& fluid, double dt)
{
    update();
    for (Link& link : links_) link.load = own_load(link, fluid, dt);
    for (std::size_t k = links_.size(); k-- > 0;) { // children come after their parents
        const Link& link = links_[k];
        if (link.parent) links_[*link.parent].load += link.load;
    }
    for (Link& link : links_)
        if (link.joint) link.now.wrench = link.load.seen_at(-link.pivot);
}

Wrench Articulation::momentum(const Link& link) const
{
    const int number = link.number + 1;
    return inertia_of(*body_, number, kinematics_.pose(number)) * kinematics_.twist(number, velocity_);
}

/// What the change of its momentum needs beyond gravity, water and contacts, about the world's origin.
Wrench Articulation::own_load(const Link& link, const FluidWorld& fluid, double dt) const
{
    Wrench load = (momentum(link) - link.before) * (1.0 / dt) - fluid.fluid_wrench(static_cast<int>(link.body));
    load.linear -= inertia_of(*body_, link.number + 1, Pose()).mass * from_bullet(world_.getGravity());
    return load.seen_at(link.center) - contact_impulse(*link.collider, world_) * (1.0 / dt);
}

void Articulation::update()
{
    kinematics_.update(*body_);
    velocity_.resize(kinematics_.dofs());
    for (int k = 0; k < kinematics_.dofs(); ++k) velocity_[k] = static_cast<double>(body_->getVelocityVector()[k]);
    for (Link& link : links_)
        if (link.joint) link.now.position = position(link);
}

double Articulation::position(const Link& link) const
{
    if (link.of.type == Type::slider || turns_about_axis(link.of))
        return static_cast<double>(body_->getJointPos(link.number));
    const btScalar* q = body_->getJointPosMultiDof(link.number);
    const Vec3d part(static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2]));
    return 2.0 * std::atan2(part.norm(), std::abs(static_cast<double>(q[3])));
}

} // namespace flotsam::scene
