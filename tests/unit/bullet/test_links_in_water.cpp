#include "flotsam/bullet/bullet_coupling.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "multibody_scene.hpp"
#include "support/catch.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>

#include <cmath>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kLength = 0.2, kWidth = 0.1; // of a link [m]

/// Three links on a fixed base at (0.5, 0.3, z) that turn about y; at 0 they hang straight down.
struct Arm {
    MultibodyScene scene;
    btMultiBody* body = nullptr;

    Arm(double z, double link_mass)
    {
        scene.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
        auto made = std::make_unique<btMultiBody>(3, btScalar(0), btVector3(1, 1, 1), true, false);
        made->setBasePos(btVector3(btScalar(0.5), btScalar(0.3), static_cast<btScalar>(z)));
        const double turning = link_mass / 12.0 * (kLength * kLength + kWidth * kWidth);
        const btVector3 inertia = to_bullet(Vec3d(turning, turning, link_mass / 6.0 * kWidth * kWidth));
        const btVector3 half(0, 0, static_cast<btScalar>(-0.5 * kLength));
        for (int k = 0; k < 3; ++k)
            made->setupRevolute(k, static_cast<btScalar>(link_mass), inertia, k - 1, btQuaternion::getIdentity(),
                                btVector3(0, 1, 0), k == 0 ? btVector3(0, 0, 0) : half, half, true);
        made->setLinearDamping(0);
        made->setAngularDamping(0);
        body = &scene.add(std::move(made));
    }
    void couple(BulletCoupling& coupling) const
    {
        const TriangleMesh link = tessellate(BoxShape{Vec3d(kWidth, kWidth, kLength)}, 0.5 * kWidth);
        for (int k = 0; k < 3; ++k) coupling.add(*body->getLink(k).m_collider, link);
    }
};

FluidWorld tank(double spacing, double depth)
{
    FluidWorldSettings settings;
    settings.particle_spacing = spacing;
    settings.threads = 2;
    FluidWorld water(settings);
    water.add_box_wall({Vec3d(0, 0, 0), Vec3d(1.0, 0.6, 1.0)}, {"+z"});
    if (depth > 0.0) water.add_block({Vec3d(0, 0, 0), Vec3d(1.0, 0.6, depth)});
    return water;
}

} // namespace

TEST_CASE("an arm without water moves as Bullet alone moves it, bit for bit", "[bullet][links]")
{
    Arm alone(0.9, 3.0), coupled(0.9, 3.0);
    FluidWorld dry = tank(0.05, 0.0);
    BulletCoupling coupling(dry, coupled.scene.world);
    coupled.couple(coupling);
    for (Arm* arm : {&alone, &coupled}) {
        const btScalar angle = btScalar(0.7);
        arm->body->setJointPosMultiDof(1, &angle);
    }
    for (int k = 0; k < 100; ++k) {
        const double dt = coupling.step(0.004).dt;
        alone.scene.step(dt);
        for (int joint = 0; joint < 3; ++joint)
            REQUIRE(alone.body->getJointPos(joint) == coupled.body->getJointPos(joint));
    }
    CHECK(std::abs(alone.body->getJointPos(0)) > btScalar(0.01)); // it swings
}

TEST_CASE("motors that hold an arm in water bear its weight less that of the water it displaces", "[bullet][links]")
{
    // Straight and level under water, links of 2.5 times the water's density.
    const double mass = 5.0, displaced = 1000.0 * kLength * kWidth * kWidth;
    Arm arm(0.45, mass);
    const btScalar level = btScalar(-0.5 * 3.14159265358979); // about y: to +x
    arm.body->setJointPosMultiDof(0, &level);
    FluidWorld water = tank(0.025, 0.7);
    BulletCoupling coupling(water, arm.scene.world);
    arm.couple(coupling);
    std::vector<btMultiBodyJointMotor*> motors;
    for (int k = 0; k < 3; ++k)
        motors.push_back(&arm.scene.constrain<btMultiBodyJointMotor>(arm.body, k, btScalar(0), btScalar(10)));
    // The base is 0.05 off the left wall's third so that all three links fit: 0.5 to 1.1 would not.
    arm.body->setBasePos(btVector3(btScalar(0.2), btScalar(0.3), btScalar(0.45)));
    double torque[3] = {}, seconds = 0.0;
    while (water.time() < 0.9) {
        const double dt = coupling.step(0.004).dt;
        if (water.time() < 0.5) continue; // the water settles
        for (int k = 0; k < 3; ++k)
            torque[k] += static_cast<double>(motors[static_cast<std::size_t>(k)]->getAppliedImpulse(0));
        seconds += dt;
    }
    const double weight = 9.81 * (mass - displaced);
    const double arms[3] = {0.1 + 0.3 + 0.5, 0.1 + 0.3, 0.1}; // of the links beyond each joint
    for (int k = 0; k < 3; ++k) {
        CAPTURE(k, torque[k] / seconds, weight * arms[k]);
        CHECK(std::abs(torque[k] / seconds) == Approx(weight * arms[k]).epsilon(0.05)); // links of 4 x 4 x 8 spacings
    }
    CHECK(std::abs(arm.body->getJointPos(0) - level) < btScalar(0.01));
}

TEST_CASE("a light arm in water is no special case", "[bullet][links]")
{
    Arm arm(0.75, 0.02); // a hundredth of the water's density: it would explode if coupled from step to step
    FluidWorld water = tank(0.04, 0.6);
    BulletCoupling coupling(water, arm.scene.world);
    arm.couple(coupling);
    const btScalar angle = btScalar(0.3);
    arm.body->setJointPosMultiDof(0, &angle);
    int steps = 0, iterations = 0;
    double fastest = 0.0;
    for (; water.time() < 0.5; ++steps) {
        iterations += coupling.step(0.004).iterations;
        for (int k = 0; k < 3; ++k)
            fastest = std::max(fastest, std::abs(static_cast<double>(arm.body->getJointVel(k))));
    }
    CHECK(iterations < 100 * steps);
    CHECK(fastest < 200.0); // [rad/s]: it floats up, a hundred times lighter than what pushes it
    CHECK(std::isfinite(static_cast<double>(arm.body->getJointPos(2))));
}
