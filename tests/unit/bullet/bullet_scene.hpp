#pragma once

#include "bullet/bullet_bodies.hpp"
#include "bullet/convert.hpp"

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <random>
#include <vector>

namespace flotsam::test {

/// Of quantities around 1 that went through Bullet's number type a few times.
inline constexpr double kTolerance = sizeof(btScalar) == 8 ? 1e-9 : 2e-4;

/// A Bullet world that owns what is put into it.
class BulletScene {
  public:
    explicit BulletScene(const Vec3d& gravity = Vec3d(0, 0, -9.81)) { world.setGravity(to_bullet(gravity)); }
    ~BulletScene()
    {
        for (auto& body : bodies_) world.removeRigidBody(body.get());
    }
    BulletScene(const BulletScene&) = delete;
    BulletScene& operator=(const BulletScene&) = delete;

    template <class Shape, class... Args>
    Shape& shape(Args&&... args)
    {
        auto made = std::make_unique<Shape>(std::forward<Args>(args)...);
        Shape& reference = *made;
        shapes_.push_back(std::move(made));
        return reference;
    }
    btRigidBody& add(const btRigidBody::btRigidBodyConstructionInfo& info)
    {
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        world.addRigidBody(bodies_.back().get());
        return *bodies_.back();
    }
    /// A box of edges 0.2, 0.3 and 0.5 m; mass 0 is static.
    btRigidBody& add_box(double mass, const Vec3d& position = Vec3d::Zero())
    {
        auto& box = shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.15), btScalar(0.25)));
        btVector3 inertia(0, 0, 0);
        if (mass > 0.0) box.calculateLocalInertia(static_cast<btScalar>(mass), inertia);
        btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, &box, inertia);
        info.m_startWorldTransform.setOrigin(to_bullet(position));
        return add(info);
    }
    btRigidBody& add_kinematic(const Vec3d& position = Vec3d::Zero(), btMotionState* motion_state = nullptr)
    {
        auto& box = shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1)));
        btRigidBody::btRigidBodyConstructionInfo info(0, motion_state, &box);
        info.m_startWorldTransform.setOrigin(to_bullet(position));
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        btRigidBody& body = *bodies_.back();
        body.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
        world.addRigidBody(&body);
        return body;
    }
    void step(double dt) { world.stepSimulation(static_cast<btScalar>(dt), 0); }

  private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_{&configuration_};
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;

  public:
    btDiscreteDynamicsWorld world{&dispatcher_, &broadphase_, &solver_, &configuration_};
};

inline Twist velocity(const btRigidBody& body)
{
    return twist_from_bullet(body.getLinearVelocity(), body.getAngularVelocity());
}

inline double difference(const Twist& a, const Twist& b)
{
    return (a.linear - b.linear).norm() + (a.angular - b.angular).norm();
}

/// Numbers in [-1, 1] that repeat.
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double number() { return 2.0 * (static_cast<double>(engine_()) / 4294967295.0) - 1.0; }
    double number(double from, double to) { return from + 0.5 * (number() + 1.0) * (to - from); }
    Vec3d vector()
    {
        const double x = number(), y = number(), z = number();
        return {x, y, z};
    }
    Wrench wrench()
    {
        const Vec3d linear = vector(), angular = vector();
        return {linear, angular};
    }

  private:
    std::mt19937 engine_;
};

/// A body of random mass, inertia, pose and velocity, with random forces on it.
inline btRigidBody& add_random_body(BulletScene& scene, Random& random, double linear_damping = 0.0,
                                    double angular_damping = 0.0, bool additional_damping = false)
{
    auto& shape = scene.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1)));
    const Vec3d inertia = Vec3d(1.0, 1.1, 1.2) + 0.5 * random.vector();
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(random.number(0.5, 3.0)), nullptr, &shape,
                                                  to_bullet(inertia));
    info.m_linearDamping = static_cast<btScalar>(linear_damping);
    info.m_angularDamping = static_cast<btScalar>(angular_damping);
    info.m_additionalDamping = additional_damping;
    const Vec3d axis = random.vector();
    info.m_startWorldTransform.setRotation({to_bullet(axis.normalized()), static_cast<btScalar>(axis.norm())});
    btRigidBody& body = scene.add(info);
    body.setLinearVelocity(to_bullet(random.vector()));
    body.setAngularVelocity(to_bullet(4.0 * random.vector()));
    body.applyCentralForce(to_bullet(10.0 * random.vector()));
    body.applyTorque(to_bullet(10.0 * random.vector()));
    return body;
}

} // namespace flotsam::test
