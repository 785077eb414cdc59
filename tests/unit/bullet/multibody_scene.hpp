#pragma once

#include "bullet/multibody_motion.hpp"
#include "bullet_scene.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointFeedback.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <string>

namespace flotsam::test {

/// A Bullet world of multibodies that owns what is put into it. Nothing in it collides.
class MultibodyScene {
  public:
    MultibodyScene() { world.setGravity(to_bullet(gravity)); }
    ~MultibodyScene()
    {
        for (auto& constraint : constraints_) world.removeMultiBodyConstraint(constraint.get());
        for (auto& body : rigid_bodies_) world.removeRigidBody(body.get());
        for (auto& collider : colliders_) world.removeCollisionObject(collider.get());
        for (auto& body : bodies_) world.removeMultiBody(body.get());
    }
    MultibodyScene(const MultibodyScene&) = delete;
    MultibodyScene& operator=(const MultibodyScene&) = delete;

    btMultiBody& add(std::unique_ptr<btMultiBody> made)
    {
        btMultiBody& body = *made;
        bodies_.push_back(std::move(made));
        body.finalizeMultiDof();
        world.addMultiBody(&body);
        body.setBaseCollider(collider(body, -1));
        for (int k = 0; k < body.getNumLinks(); ++k) body.getLink(k).m_collider = collider(body, k);
        return body;
    }
    template <class Constraint, class... Args>
    Constraint& constrain(Args&&... args)
    {
        auto made = std::make_unique<Constraint>(std::forward<Args>(args)...);
        Constraint& reference = *made;
        constraints_.push_back(std::move(made));
        reference.finalizeMultiDof();
        world.addMultiBodyConstraint(&reference);
        return reference;
    }
    btRigidBody& add_rigid(double mass, const Vec3d& position)
    {
        btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, &shape_,
                                                      btVector3(btScalar(0.3), btScalar(0.4), btScalar(0.5)));
        info.m_startWorldTransform.setOrigin(to_bullet(position));
        rigid_bodies_.push_back(std::make_unique<btRigidBody>(info));
        world.addRigidBody(rigid_bodies_.back().get(), 0, 0);
        return *rigid_bodies_.back();
    }
    void step(double dt) { world.stepSimulation(static_cast<btScalar>(dt), 0); }

    const Vec3d gravity{0.7, -0.4, -9.81};

  private:
    btMultiBodyLinkCollider* collider(btMultiBody& body, int link)
    {
        colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(&body, link));
        colliders_.back()->setCollisionShape(&shape_);
        world.addCollisionObject(colliders_.back().get(), 0, 0);
        return colliders_.back().get();
    }

    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    btSphereShape shape_{btScalar(0.05)};
    std::vector<std::unique_ptr<btMultiBody>> bodies_;
    std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
    std::vector<std::unique_ptr<btRigidBody>> rigid_bodies_;
    std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;

  public:
    btMultiBodyDynamicsWorld world{&dispatcher_, &broadphase_, &solver_, &configuration_};
};

inline btQuaternion random_rotation(Random& random)
{
    const Vec3d axis = random.vector();
    return {to_bullet(axis.normalized()), static_cast<btScalar>(3.0 * axis.norm())};
}

inline btVector3 random_inertia(Random& random)
{
    return to_bullet(Vec3d(Vec3d(0.20, 0.22, 0.24) + 0.1 * random.vector()));
}

/// Joints by letter: revolute, prismatic, spherical, planar, fixed.
inline void set_joint(btMultiBody& body, int link, int parent, char type, Random& random)
{
    const auto mass = static_cast<btScalar>(random.number(0.5, 3.0));
    const btVector3 inertia = random_inertia(random);
    const btQuaternion rotation = random_rotation(random);
    const btVector3 axis = to_bullet(random.vector().normalized());
    const btVector3 to_pivot = to_bullet(0.3 * random.vector()), to_centre = to_bullet(0.3 * random.vector());
    switch (type) {
    case 'r':
        return body.setupRevolute(link, mass, inertia, parent, rotation, axis, to_pivot, to_centre);
    case 'p':
        return body.setupPrismatic(link, mass, inertia, parent, rotation, axis, to_pivot, to_centre, false);
    case 's':
        return body.setupSpherical(link, mass, inertia, parent, rotation, to_pivot, to_centre);
    case 'l':
        return body.setupPlanar(link, mass, inertia, parent, rotation, axis, to_pivot);
    default:
        return body.setupFixed(link, mass, inertia, parent, rotation, to_pivot, to_centre);
    }
}

/// Random pose and velocities of all joints and of a base that is free.
inline void set_random_state(btMultiBody& body, Random& random)
{
    body.setBasePos(to_bullet(random.vector()));
    body.setWorldToBaseRot(random_rotation(random));
    if (!body.hasFixedBase()) {
        body.setBaseVel(to_bullet(random.vector()));
        body.setBaseOmega(to_bullet(2.0 * random.vector()));
    }
    for (int k = 0; k < body.getNumLinks(); ++k) {
        std::array<btScalar, 7> position{}, velocity{};
        for (btScalar& number : position) number = static_cast<btScalar>(random.number());
        for (btScalar& number : velocity) number = static_cast<btScalar>(2.0 * random.number());
        if (body.getLink(k).m_jointType == btMultibodyLink::eSpherical) {
            const btQuaternion turned = random_rotation(random);
            position = {turned.x(), turned.y(), turned.z(), turned.w()};
        }
        body.setJointPosMultiDof(k, position.data());
        body.setJointVelMultiDof(k, velocity.data());
    }
}

/// A tree with one joint per letter: chains with a branch, everything about it random.
inline btMultiBody& add_random_multibody(MultibodyScene& scene, const std::string& joints, bool is_fixed,
                                         Random& random)
{
    const int links = static_cast<int>(joints.size());
    auto body = std::make_unique<btMultiBody>(links, static_cast<btScalar>(random.number(0.5, 3.0)),
                                              random_inertia(random), is_fixed, true);
    for (int k = 0; k < links; ++k)
        set_joint(*body, k, k == 3 ? 0 : k - 1, joints[static_cast<std::size_t>(k)], random);
    btMultiBody& added = scene.add(std::move(body));
    set_random_state(added, random);
    return added;
}

/// Forces, torques and joint torques as an application applies them.
inline void add_random_forces(btMultiBody& body, Random& random)
{
    body.addBaseForce(to_bullet(5.0 * random.vector()));
    body.addBaseTorque(to_bullet(5.0 * random.vector()));
    for (int k = 0; k < body.getNumLinks(); ++k) {
        body.addLinkForce(k, to_bullet(5.0 * random.vector()));
        body.addLinkTorque(k, to_bullet(5.0 * random.vector()));
        for (int dof = 0; dof < body.getLink(k).m_dofCount; ++dof)
            body.addJointTorqueMultiDof(k, dof, static_cast<btScalar>(random.number()));
    }
}

inline std::vector<Wrench> random_impulses(int count, Random& random, double size = 0.1)
{
    std::vector<Wrench> impulses;
    for (int k = 0; k < count; ++k) impulses.push_back(random.wrench() * size);
    return impulses;
}

/// Bullet's velocities in joint space.
inline Eigen::VectorXd joint_velocity(const btMultiBody& body)
{
    Eigen::VectorXd velocity(6 + body.getNumDofs());
    for (int k = 0; k < velocity.size(); ++k) velocity[k] = static_cast<double>(body.getVelocityVector()[k]);
    return velocity;
}

/// Twists of all links that these velocities are at the pose of the last read.
inline std::vector<Twist> twists_of(const MultibodyMotion& motion, const Eigen::VectorXd& joint_velocity)
{
    std::vector<Twist> twists;
    for (int link = 0; link < motion.size(); ++link) twists.push_back(motion.kinematics().twist(link, joint_velocity));
    return twists;
}

} // namespace flotsam::test
