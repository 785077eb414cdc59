#include "bullet_scene.hpp"
#include "flotsam/bullet/bullet_coupling.hpp"
#include "support/catch.hpp"

#include <limits>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kStep = 0.01;

/// One step with the same impulse on every body; returns the states that the port gave.
std::vector<BodyState> step(BulletScene& scene, BulletBodies& port, const Wrench& impulse = {})
{
    std::vector<BodyState> states(port.size());
    port.read(kStep, states);
    port.apply(std::vector<Wrench>(port.size(), impulse));
    port.before_bullet_step(kStep);
    scene.step(kStep);
    port.after_bullet_step();
    return states;
}

Vec3d position(const btRigidBody& body)
{
    return from_bullet(body.getWorldTransform().getOrigin());
}

} // namespace

TEST_CASE("a body that water carries stays awake and where it is", "[bullet][sleeping]")
{
    BulletScene scene;
    btRigidBody& body = scene.add_box(2.0);
    BulletBodies port(scene.world);
    port.add(body);
    for (int k = 0; k < 400; ++k) step(scene, port, {Vec3d(0, 0, 2.0 * 9.81 * kStep), Vec3d::Zero()}); // 4 s
    CHECK(body.isActive());
    CHECK(position(body).norm() < (sizeof(btScalar) == 8 ? 1e-9 : 1e-4));
}

TEST_CASE("a sleeping body sleeps on without water and is woken by it without a jerk", "[bullet][sleeping]")
{
    BulletScene scene;
    btRigidBody& body = scene.add_box(2.0);
    body.forceActivationState(ISLAND_SLEEPING);
    BulletBodies port(scene.world);
    port.add(body);
    for (int k = 0; k < 10; ++k) {
        const BodyState state = step(scene, port).at(0);
        CHECK(state.responds); // water may push it
        CHECK(state.predicted.linear.norm() == 0.0);
    }
    REQUIRE_FALSE(body.isActive());
    CHECK(position(body).norm() == 0.0);

    step(scene, port, {Vec3d(0.5, 0, 0), Vec3d::Zero()});
    CHECK(body.isActive());
    CHECK(difference(velocity(body), {Vec3d(0.25, 0, 0), Vec3d::Zero()}) < kTolerance); // what held it still does
    step(scene, port);
    CHECK(difference(velocity(body), {Vec3d(0.25, 0, -9.81 * kStep), Vec3d::Zero()}) < kTolerance);
}

TEST_CASE("a body out of the water may fall asleep", "[bullet][sleeping]")
{
    BulletScene scene;
    auto& ground = scene.shape<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
    scene.add({0, nullptr, &ground});
    btRigidBody& body = scene.add_box(2.0, Vec3d(0, 0, 0.25));
    BulletBodies port(scene.world);
    port.add(body);
    for (int k = 0; k < 400 && body.isActive(); ++k) step(scene, port);
    CHECK_FALSE(body.isActive());
}

TEST_CASE("static bodies and ones out of the simulation do not respond", "[bullet]")
{
    BulletScene scene;
    btRigidBody& fixed = scene.add_box(0.0, Vec3d(1, 2, 3));
    btRigidBody& disabled = scene.add_box(1.0, Vec3d(4, 5, 6));
    disabled.forceActivationState(DISABLE_SIMULATION);
    BulletBodies port(scene.world);
    port.add(fixed);
    port.add(disabled);
    const auto states = step(scene, port, {Vec3d::Ones(), Vec3d::Ones()});
    std::vector<Twist> twists(2);
    port.respond(std::vector<Wrench>(2, {Vec3d::Ones(), Vec3d::Ones()}), twists);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK_FALSE(states[k].responds);
        CHECK(difference(states[k].predicted, {}) == 0.0);
        CHECK(difference(twists[k], {}) == 0.0);
    }
    CHECK((states[0].pose.position - Vec3d(1, 2, 3)).norm() < kTolerance);
    CHECK((position(disabled) - Vec3d(4, 5, 6)).norm() < kTolerance);
}

TEST_CASE("a kinematic body goes on with the velocity that is set on it", "[bullet][kinematic]")
{
    const bool has_motion_state = GENERATE(false, true);
    BulletScene scene;
    btDefaultMotionState motion_state(btTransform::getIdentity(), btTransform(btQuaternion(0, 0, 0, 1), {0, 0, 1}));
    btRigidBody& body = scene.add_kinematic(Vec3d::Zero(), has_motion_state ? &motion_state : nullptr);
    const Vec3d start = position(body), linear(0.3, -0.2, 0.1), angular(0.0, 0.0, 0.7);
    body.setLinearVelocity(to_bullet(linear));
    body.setAngularVelocity(to_bullet(angular));
    BulletBodies port(scene.world);
    port.add(body);
    for (int k = 0; k < 400; ++k) { // long enough to fall asleep, which it must not
        const BodyState state = step(scene, port, {Vec3d::Ones(), Vec3d::Ones()}).at(0);
        CHECK_FALSE(state.responds);
        REQUIRE(difference(state.predicted, {linear, angular}) < 1e-6); // of the step's length: no drift
        REQUIRE((state.pose.position - start - linear * (k * kStep)).norm() < 10 * kTolerance);
    }
    CHECK(difference(velocity(body), {linear, angular}) < 20 * kTolerance); // for Bullet's contacts
    const Quatd turned(Eigen::AngleAxisd(0.7 * 400 * kStep, Vec3d::UnitZ()));
    CHECK(from_bullet(body.getWorldTransform()).orientation.angularDistance(turned) < 10 * kTolerance);

    body.setLinearVelocity(btVector3(0, 0, 0)); // now stop
    body.setAngularVelocity(btVector3(0, 0, 0));
    const Vec3d end = position(body);
    for (int k = 0; k < 3; ++k) CHECK(difference(step(scene, port).at(0).predicted, {}) == 0.0);
    CHECK((position(body) - end).norm() == 0.0);
}

TEST_CASE("a velocity that is none is refused, and forgotten when it is taken back", "[bullet][kinematic]")
{
    const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
    BulletScene scene;
    FluidWorld fluid({});
    BulletCoupling coupling(fluid, scene.world);
    btRigidBody& dynamic = scene.add_box(1.0);
    btRigidBody& kinematic = scene.add_kinematic(Vec3d(5, 0, 0));
    coupling.add(dynamic);
    coupling.add(kinematic);
    for (btRigidBody* body : {&dynamic, &kinematic}) {
        coupling.step(0.004);
        const btVector3 before = body->getLinearVelocity();
        body->setLinearVelocity(btVector3(nan, 0, 0));
        CHECK_THROWS_WITH(coupling.step(0.004), Catch::Matchers::Contains("must have a finite velocity"));
        body->setLinearVelocity(before);
        CHECK_NOTHROW(coupling.step(0.004));
    }
    dynamic.applyCentralForce(btVector3(0, nan, 0));
    CHECK_THROWS_WITH(coupling.step(0.004), Catch::Matchers::Contains("body 0 must have a finite velocity"));
    dynamic.clearForces();
    CHECK_NOTHROW(coupling.step(0.004));
    CHECK(from_bullet(dynamic.getWorldTransform().getOrigin()).allFinite());
}

TEST_CASE("a kinematic body goes where the application puts it, then stands", "[bullet][kinematic]")
{
    const bool has_motion_state = GENERATE(false, true);
    BulletScene scene;
    btDefaultMotionState motion_state;
    btRigidBody& body = scene.add_kinematic(Vec3d::Zero(), has_motion_state ? &motion_state : nullptr);
    BulletBodies port(scene.world);
    port.add(body);
    CHECK(difference(step(scene, port).at(0).predicted, {}) == 0.0);

    const btTransform there(btQuaternion(btVector3(0, 0, 1), btScalar(0.02)), btVector3(btScalar(0.05), 0, 0));
    if (has_motion_state)
        motion_state.setWorldTransform(there);
    else
        body.setWorldTransform(there);
    const BodyState moving = step(scene, port).at(0);
    CHECK(moving.pose.position.norm() == 0.0); // it is still where the step starts
    CHECK(difference(moving.predicted, {Vec3d(0.05 / kStep, 0, 0), Vec3d(0, 0, 0.02 / kStep)}) < 50 * kTolerance);
    CHECK((position(body) - Vec3d(0.05, 0, 0)).norm() < kTolerance);

    const BodyState standing = step(scene, port).at(0);
    CHECK(difference(standing.predicted, {}) == 0.0);
    CHECK((standing.pose.position - Vec3d(0.05, 0, 0)).norm() < kTolerance);
}

TEST_CASE("a compound with its centre of mass off its middle moves about its centre of mass", "[bullet]")
{
    BulletScene scene(Vec3d::Zero());
    auto& light = scene.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1)));
    auto& heavy = scene.shape<btSphereShape>(btScalar(0.1));
    auto& parts = scene.shape<btCompoundShape>();
    parts.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(-1, 0, 0)), &light);
    parts.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(1, 0, 0)), &heavy);
    const btScalar masses[] = {1, 3};
    btTransform principal;
    btVector3 inertia;
    parts.calculatePrincipalAxisTransform(masses, principal, inertia);
    for (int k = 0; k < 2; ++k) parts.updateChildTransform(k, principal.inverse() * parts.getChildTransform(k));
    btRigidBody::btRigidBodyConstructionInfo info(4, nullptr, &parts, inertia);
    info.m_startWorldTransform = principal; // so that the parts are at -1 and 1 in the world
    btRigidBody& body = scene.add(info);
    BulletBodies port(scene.world);
    port.add(body);

    const BodyState state = step(scene, port, {Vec3d(0, 0, 1), Vec3d::Zero()}).at(0);
    CHECK((state.pose.position - Vec3d(0.5, 0, 0)).norm() < kTolerance);
    CHECK(difference(velocity(body), {Vec3d(0, 0, 0.25), Vec3d::Zero()}) < kTolerance); // does not turn
}
