#include "bullet_scene.hpp"
#include "support/catch.hpp"

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kStep = 0.004;

BodyState read_one(BulletBodies& port, double dt = kStep)
{
    std::vector<BodyState> states(port.size());
    port.read(dt, states);
    return states.at(0);
}

Vec3d bits(int mask)
{
    return {mask & 1 ? 1.0 : 0.0, mask & 2 ? 1.0 : 0.0, mask & 4 ? 1.0 : 0.0};
}

} // namespace

TEST_CASE("the predicted twist is Bullet's velocity after a step of a free body", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 11u)));
    const int flags =
        GENERATE(int(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY), int(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD),
                 int(BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT), 0);
    const bool additional_damping = GENERATE(false, true);
    BulletScene scene;
    btRigidBody& body = add_random_body(scene, random, 0.3, 0.6, additional_damping);
    body.setFlags(flags);
    body.setGravity(to_bullet(10.0 * random.vector())); // of its own, not the world's
    body.setLinearFactor(to_bullet(random.vector().cwiseAbs()));
    body.setAngularFactor(to_bullet(0.5 * random.vector().cwiseAbs() + Vec3d::Constant(0.5)));
    body.applyForce(to_bullet(random.vector()), to_bullet(random.vector()));
    BulletBodies port(scene.world);
    port.add(body);

    const Twist before = velocity(body);
    const BodyState state = read_one(port);
    CHECK(state.responds);
    CHECK(difference(velocity(body), before) == 0.0); // reading changes nothing
    CHECK(difference(state.start, before) == 0.0);
    scene.step(kStep);
    REQUIRE(difference(velocity(body), before) > 1e-3);
    CHECK(difference(velocity(body), state.predicted) < kTolerance);
}

TEST_CASE("a body that ignores the world's gravity is predicted without it", "[bullet]")
{
    BulletScene scene;
    btRigidBody& body = scene.add_box(2.0);
    scene.world.removeRigidBody(&body);
    body.setFlags(body.getFlags() | BT_DISABLE_WORLD_GRAVITY);
    body.setGravity(btVector3(0, 0, 0));
    scene.world.addRigidBody(&body);
    BulletBodies port(scene.world);
    port.add(body);
    CHECK(read_one(port).predicted.linear.norm() == 0.0);
}

TEST_CASE("impulses change the velocity at the end of the step by what respond says", "[bullet][property]")
{
    Random random(GENERATE(range(1u, 6u)));
    const int free_linear = GENERATE(7, 5, 2), free_angular = GENERATE(range(0, 8));
    const double damping = GENERATE(0.0, 0.4, 1.0);
    BulletScene scene;
    btRigidBody& body = add_random_body(scene, random, damping, damping, damping == 0.4);
    body.setLinearFactor(to_bullet(bits(free_linear)));
    body.setAngularFactor(to_bullet(bits(free_angular)));
    body.applyTorque(to_bullet(random.vector()));
    BulletBodies port(scene.world);
    port.add(body);

    const BodyState state = read_one(port);
    const std::vector<Wrench> impulses{random.wrench()};
    std::vector<Twist> answer(1);
    port.respond(impulses, answer);
    port.apply(impulses);
    scene.step(kStep);
    const Twist expected{state.predicted.linear + answer[0].linear, state.predicted.angular + answer[0].angular};
    REQUIRE(answer[0].linear.norm() > 1e-3);
    CHECK(difference(velocity(body), expected) < kTolerance);
    CHECK(body.getLinearFactor() == to_bullet(bits(free_linear))); // put back
    CHECK(body.getAngularFactor() == to_bullet(bits(free_angular)));
    CHECK(body.getTotalForce().isZero());
}

TEST_CASE("a locked rotation axis holds against the water and gyroscopic terms", "[bullet]")
{
    BulletScene scene;
    Random random(3);
    btRigidBody& body = add_random_body(scene, random);
    body.setAngularVelocity(btVector3(0, 3, 0));
    body.setAngularFactor(btVector3(0, 1, 0));
    BulletBodies port(scene.world);
    port.add(body);
    for (int k = 0; k < 100; ++k) {
        read_one(port);
        port.apply(
            std::vector<Wrench>{{Vec3d::Zero(), Vec3d(0, kStep, 0)}}); // what the water does not touch is Bullet's
        scene.step(kStep);
    }
    const Vec3d turning = velocity(body).angular;
    REQUIRE(turning.y() > 3.1);
    CHECK(std::abs(turning.x()) + std::abs(turning.z()) < (sizeof(btScalar) == 8 ? 1e-4 : 1e-3)); // gyroscopic, of
    // second order in the torque that holds the axis
}

TEST_CASE("one Bullet step of the variable kind is as long as it says", "[bullet]")
{
    BulletScene scene;
    btDefaultMotionState motion_state;
    btRigidBody& body = scene.add_box(1.0);
    body.setMotionState(&motion_state);
    scene.step(0.0037);
    const double expected = -9.81 * 0.0037 * 0.0037;
    CHECK(from_bullet(body.getWorldTransform()).position.z() == Approx(expected).epsilon(1e-5));
    btTransform synced;
    motion_state.getWorldTransform(synced);
    CHECK(from_bullet(synced).position.z() == Approx(expected).epsilon(1e-5));
}

TEST_CASE("the port refuses what it cannot do with a sentence", "[bullet]")
{
    BulletScene scene;
    BulletBodies port(scene.world);
    port.add(scene.add_box(1.0));
    std::vector<BodyState> states(1);
    CHECK_THROWS_AS(port.apply(std::vector<Wrench>(1)), std::invalid_argument);
    CHECK_THROWS_AS(port.read(0.0, states), std::invalid_argument);
    CHECK_THROWS_AS(port.read(NAN, states), std::invalid_argument);
    CHECK_THROWS_AS(port.read(0.01, std::span<BodyState>()), std::invalid_argument);
    CHECK_THROWS_AS(port.body(1), std::invalid_argument);
    CHECK_THROWS_AS(port.body(-1), std::invalid_argument);
}
