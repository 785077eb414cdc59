#include "bullet/step_plan.hpp"
#include "bullet_scene.hpp"
#include "flotsam/bullet/bullet_coupling.hpp"
#include "support/catch.hpp"

#include <algorithm>

using namespace flotsam;
using namespace flotsam::test;

TEST_CASE("steps fill a time exactly and without a sliver", "[bullet]")
{
    const double allowed = 0.004, seconds = GENERATE(0.1, 0.0999, 0.0041, 0.004, 0.003, 1.0 / 30.0);
    double left = seconds, shortest = 1.0;
    int steps = 0;
    for (; left > 0.0 && steps < 1000; ++steps) {
        const double dt = next_step(left, allowed);
        REQUIRE(dt <= allowed);
        shortest = std::min(shortest, dt);
        left -= dt;
    }
    CHECK(left == 0.0);
    CHECK(steps == static_cast<int>(std::ceil(seconds / allowed - 1e-9)));
    CHECK(shortest > (seconds > allowed ? 0.49 * allowed : 0.99 * seconds));
}

TEST_CASE("a step that single precision has rounded up is one step all the same", "[bullet]")
{
    const double allowed = 0.004, rounded = static_cast<double>(static_cast<float>(allowed));
    REQUIRE(rounded > allowed);
    CHECK(next_step(rounded, allowed) == rounded);
    CHECK(next_step(1.001 * allowed, allowed) < allowed);
}

TEST_CASE("bodies get the numbers that they have in the fluid", "[bullet]")
{
    BulletScene scene;
    btRigidBody& first = scene.add_box(1.0);
    btRigidBody& second = scene.add_box(0.0, Vec3d(3, 0, 0));
    FluidWorld fluid({});
    BulletCoupling coupling(fluid, scene.world);
    CHECK(coupling.add(first) == 0);
    CHECK(coupling.add(second, mesh_of(*second.getCollisionShape(), 0.1)) == 1);
    CHECK(&coupling.body(1) == &second);
    CHECK(coupling.bodies().size() == 2);
    CHECK(fluid.body_count() == 2);
    CHECK(first.getAngularFactor() == btVector3(1, 1, 1)); // three dimensions lock nothing
}

TEST_CASE("in two dimensions a body is locked to the plane beside its own locks", "[bullet]")
{
    BulletScene scene;
    btRigidBody& body = scene.add_box(1.0);
    body.setLinearFactor(btVector3(0, 1, 1));
    FluidWorldSettings settings;
    settings.dimensions = 2;
    FluidWorld fluid(settings);
    BulletCoupling coupling(fluid, scene.world);
    coupling.add(body);
    CHECK(body.getLinearFactor() == btVector3(0, 0, 1));
    CHECK(body.getAngularFactor() == btVector3(0, 1, 0));
}

TEST_CASE("a Bullet world with another gravity than the water's is noted once, when bodies feel it", "[bullet]")
{
    BulletScene scene; // 9.81 m/s^2, as the water
    FluidWorld fluid({});
    BulletCoupling coupling(fluid, scene.world);
    coupling.add(scene.add_box(0.0, Vec3d(5, 0, 0)));
    scene.world.setGravity(btVector3(0, 0, 0));
    coupling.step(0.004);
    CHECK(fluid.notes().empty()); // a static body feels none
    scene.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    coupling.add(scene.add_box(1.0));
    coupling.step(0.004);
    CHECK(fluid.notes().empty());
    scene.world.setGravity(btVector3(0, 0, btScalar(-1.5)));
    for (int k = 0; k < 3; ++k) coupling.step(0.004);
    REQUIRE(fluid.notes().size() == 1);
    CHECK(fluid.notes()[0] == "bodies have a gravity of (0, 0, -1.5) m/s^2, the water one of (0, 0, -9.81) m/s^2: they "
                              "float as they would under neither");
}

TEST_CASE("a body on a joint to one that is moved goes as the fluid believes", "[bullet][kinematic]")
{
    constexpr double kSpeed = 0.3;
    const bool by_velocity = GENERATE(false, true);
    BulletScene scene;
    scene.world.getSolverInfo().m_numIterations = 200; // Bullet's own solve is not what is tested
    btRigidBody& cart = scene.add_kinematic(Vec3d(0, 0, 1));
    btRigidBody& bob = scene.add_box(2.0, Vec3d(0, 0, 0.4));
    bob.setLinearVelocity(btVector3(btScalar(kSpeed), 0, 0));
    btTransform below = btTransform::getIdentity(), above = btTransform::getIdentity();
    below.setOrigin(btVector3(0, 0, btScalar(-0.3)));
    above.setOrigin(btVector3(0, 0, btScalar(0.3)));
    btFixedConstraint joint(cart, bob, below, above);
    scene.world.addConstraint(&joint, true);
    FluidWorld fluid({});
    BulletCoupling coupling(fluid, scene.world);
    coupling.add(cart);
    coupling.add(bob);
    if (by_velocity) cart.setLinearVelocity(btVector3(btScalar(kSpeed), 0, 0));
    double most = 0.0;
    for (int k = 1; k <= 100; ++k) {
        if (!by_velocity) {
            btTransform next = cart.getWorldTransform();
            next.setOrigin(next.getOrigin() + btVector3(btScalar(kSpeed * 0.004), 0, 0));
            cart.setWorldTransform(next);
        }
        most = std::max(most, coupling.step(0.004).disagreement);
    }
    CHECK(cart.getWorldTransform().getOrigin().x() == Approx(0.12)); // it was moved
    CHECK(bob.getLinearVelocity().x() == Approx(kSpeed));            // and took the other along
    CHECK(most < 1e-3 * kSpeed);                                     // 0.2, Bullet's erp, from where it starts
    scene.world.removeConstraint(&joint);
}

TEST_CASE("what a kinematic body lifts goes as the fluid believes", "[bullet][kinematic]")
{
    constexpr double kSpeed = 0.2;
    BulletScene scene;
    btRigidBody& plate = scene.add_kinematic();
    btRigidBody& load = scene.add_box(2.0, Vec3d(0, 0, 0.35));
    load.setAngularFactor(btScalar(0)); // upright
    FluidWorld fluid({});
    BulletCoupling coupling(fluid, scene.world);
    coupling.add(plate);
    coupling.add(load);
    plate.setLinearVelocity(btVector3(0, 0, btScalar(kSpeed)));
    coupling.step_for(0.5); // until they lie on each other
    double most = 0.0;
    for (int k = 0; k < 50; ++k) most = std::max(most, coupling.step(0.004).disagreement);
    CHECK(load.getLinearVelocity().z() == Approx(kSpeed).epsilon(0.01));
    CHECK(most < 1e-3 * kSpeed);
}

TEST_CASE("the coupling refuses bodies it cannot couple", "[bullet]")
{
    BulletScene scene;
    btRigidBody& body = scene.add_box(1.0);
    btBoxShape shape(btVector3(1, 1, 1));
    btRigidBody outside(1, nullptr, &shape, btVector3(1, 1, 1)), shapeless(1, nullptr, nullptr);
    FluidWorld fluid({});
    BulletCoupling coupling(fluid, scene.world);
    CHECK_THROWS_AS(coupling.add(outside), std::invalid_argument);
    CHECK_THROWS_AS(coupling.add(shapeless), std::invalid_argument);
    coupling.add(body);
    CHECK_THROWS_AS(coupling.add(body), std::invalid_argument);
    CHECK(fluid.body_count() == 1);
    CHECK_THROWS_AS(coupling.body(1), std::invalid_argument);
    CHECK_THROWS_AS(coupling.step(0.0), std::invalid_argument);
    CHECK_THROWS_AS(coupling.step_for(-1.0), std::invalid_argument);
}
