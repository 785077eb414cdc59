#include "multibody_row_solver.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyFixedConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyGearConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <BulletDynamics/Featherstone/btMultiBodySliderConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodySphericalJointMotor.h>

using namespace flotsam;
using namespace flotsam::test;

namespace {

btVector3 random_point(Random& random)
{
    return to_bullet(0.3 * random.vector());
}

btMatrix3x3 random_frame(Random& random)
{
    return btMatrix3x3(random_rotation(random));
}

} // namespace

TEST_CASE("motors of joints as rows: velocity, position, gains, limits of force and speed", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 4u)));
    const bool is_fixed = GENERATE(false, true);
    const std::string kind = GENERATE("velocity", "position", "soft", "force only", "weak", "slow");
    MultibodyScene scene;
    CAPTURE(kind, is_fixed);
    btMultiBody& body = add_random_multibody(scene, "rprp", is_fixed, random);
    for (int link = 0; link < 4; ++link) {
        const btScalar largest = kind == "weak" ? btScalar(0.001) : btScalar(1000);
        auto& motor = scene.constrain<btMultiBodyJointMotor>(&body, link, btScalar(random.number()), largest);
        if (kind == "position") motor.setPositionTarget(btScalar(random.number()), btScalar(0.1));
        if (kind == "soft") motor.setVelocityTarget(btScalar(random.number()), btScalar(0.3));
        if (kind == "force only") {
            motor.setVelocityTarget(0, 0);
            motor.setPositionTarget(btScalar(random.number()), btScalar(0.01));
        }
        if (kind == "slow") {
            motor.setPositionTarget(btScalar(10), btScalar(1));
            motor.setVelocityTarget(0, btScalar(0.7)); // the clamp holds in full
            motor.setRhsClamp(btScalar(0.5));
        }
        if (kind == "soft" || kind == "force only") break; // exact where a row is alone
    }
    RowSolver solver(scene, random);
    solver.predict();
    REQUIRE(!solver.rows.empty());
    for (std::size_t k = 0; k < solver.rows.size(); ++k) {
        const double reached = solver.velocity_of(solver.rows[k]);
        if (kind == "velocity" || kind == "position") CHECK(reached == Approx(solver.rows[k].target).margin(kSolved));
        if (kind == "slow") CHECK(reached == Approx(0.5).margin(kSolved));
        if (kind == "weak") CHECK(std::abs(solver.impulse(k)) == Approx(0.001));
    }
    solver.check();
}

TEST_CASE("limits of joints as rows", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 6u)));
    const char type = GENERATE('r', 'p');
    const bool is_lower = GENERATE(false, true);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, std::string("s") + type + "r", GENERATE(false, true), random);
    const btScalar now = body.getJointPos(1), beyond = btScalar(0.01);
    scene.constrain<btMultiBodyJointLimitConstraint>(&body, 1, is_lower ? now + beyond : now - 1,
                                                     is_lower ? now + 1 : now - beyond);
    body.getJointVelMultiDof(1)[0] = is_lower ? -2 : 2; // into it
    RowSolver solver(scene, random);
    solver.predict();
    REQUIRE(solver.rows.size() == 1);
    CHECK(solver.rows[0].number == (is_lower ? 0 : 1));
    CHECK(solver.impulse(0) > 0.0);
    CHECK(solver.rows[0].target == Approx(0.01 * 0.2 / kStep).epsilon(sizeof(btScalar) == 8 ? 1e-9 : 1e-3)); // ERP 0.2
    solver.check();
}

TEST_CASE("a limit that is let go of goes on reporting its last impulse, without a row", "[bullet]")
{
    Random random(1);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "r", true, random);
    const btScalar now = body.getJointPos(0);
    auto& limit = scene.constrain<btMultiBodyJointLimitConstraint>(&body, 0, now, now + 1);
    body.getJointVelMultiDof(0)[0] = -2;
    scene.step(kStep);
    const double force = row_force(limit, 0, kStep);
    REQUIRE(force > 0.0);
    body.setJointPos(0, now + btScalar(0.5));
    scene.step(kStep);
    CHECK(limit.getPosition(0) > 0);
    CHECK(row_force(limit, 0, kStep) == force);
    CHECK_THROWS_AS(row_force(limit, 2, kStep), std::invalid_argument);
}

TEST_CASE("a limit that is not reached has no row", "[bullet]")
{
    Random random(1);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "r", true, random);
    scene.constrain<btMultiBodyJointLimitConstraint>(&body, 0, body.getJointPos(0) - 1, body.getJointPos(0) + 1);
    RowSolver solver(scene, random);
    solver.predict();
    CHECK(solver.rows.empty());
}

TEST_CASE("motors of ball joints as rows", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 6u)));
    const double damping = GENERATE(1.0, 0.2);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "rsr", GENERATE(false, true), random);
    auto& motor = scene.constrain<btMultiBodySphericalJointMotor>(&body, 1, btScalar(1000));
    motor.setPositionTarget(random_rotation(random), btScalar(0.05));
    RowSolver solver(scene, random);
    const auto d = btScalar(damping);
    motor.setDamping({d, d, d});
    solver.predict();
    REQUIRE(solver.rows.size() == 3);
    CHECK((solver.rows[0].cfm > 0.0) == (damping < 1.0));
    if (damping == 1.0) solver.check(); // with less the three rows act on one joint
}

TEST_CASE("the damping of a ball joint's motor is exact about axes that do not move each other", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 4u)));
    MultibodyScene scene;
    const btVector3 inertia(1, 1, 1), up(0, 0, btScalar(0.3));
    auto made = std::make_unique<btMultiBody>(1, btScalar(2), inertia, false, true);
    made->setupSpherical(0, 1, inertia, -1, btQuaternion::getIdentity(), up, up);
    btMultiBody& body = scene.add(std::move(made));
    auto& motor = scene.constrain<btMultiBodySphericalJointMotor>(&body, 0, btScalar(1000));
    motor.setPositionTarget(random_rotation(random), btScalar(0.05));
    motor.setDamping({btScalar(0.2), btScalar(0.5), btScalar(0.8)});
    RowSolver solver(scene, random);
    solver.predict();
    REQUIRE(solver.rows.size() == 3);
    solver.check();
}

TEST_CASE("constraints between links, multibodies, rigid bodies and the world as rows", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 4u)));
    const std::string kind = GENERATE("point", "fixed", "slider");
    const std::string other = GENERATE("link", "multibody", "body", "world");
    MultibodyScene scene;
    const bool is_fixed = GENERATE(false, true);
    btMultiBody& body = add_random_multibody(scene, "sssr", is_fixed, random);
    scene.world.getSolverInfo().m_erp = btScalar(0.001); // positions do not fit at all
    CAPTURE(kind, other, is_fixed);
    btMultiBody* second = other == "link" ? &body : nullptr;
    if (other == "multibody") second = &add_random_multibody(scene, "sr", false, random);
    btRigidBody* rigid = other == "body" ? &scene.add_rigid(2.0, random.vector()) : nullptr;
    if (rigid != nullptr) rigid->setGravity({0, 0, 0}); // Bullet's rows see it a step late
    const auto constrain = [&](auto&... ends) {
        const btVector3 a = random_point(random), b = random_point(random), axis(0, 0, 1);
        const btMatrix3x3 frame_a = random_frame(random), frame_b = random_frame(random);
        if (kind == "point") scene.constrain<btMultiBodyPoint2Point>(&body, 3, ends..., a, b);
        if (kind == "fixed") scene.constrain<btMultiBodyFixedConstraint>(&body, 3, ends..., a, b, frame_a, frame_b);
        if (kind == "slider")
            scene.constrain<btMultiBodySliderConstraint>(&body, 3, ends..., a, b, frame_a, frame_b, axis);
    };
    const int link = other == "link" ? -1 : 0;
    if (second != nullptr)
        constrain(second, link);
    else
        constrain(rigid);
    RowSolver solver(scene, random);
    if (rigid != nullptr) solver.rigid_bodies.push_back(rigid);
    solver.predict();
    REQUIRE(solver.rows.size() == (kind == "point" ? 3 : kind == "fixed" ? 6 : 5));
    CHECK(solver.rows[0].b.body == rigid);
    CHECK(solver.rows[0].b.multibody == second);
    solver.check();
}

TEST_CASE("a gear has no rows between two twists", "[bullet]")
{
    Random random(1);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "rr", true, random);
    btMultiBodyGearConstraint gear(&body, 0, &body, 1, {0, 0, 0}, {0, 0, 0}, btMatrix3x3::getIdentity(),
                                   btMatrix3x3::getIdentity());
    MultibodyRows rows_of;
    std::vector<MultibodyRow> rows;
    CHECK_FALSE(rows_of.append(gear, kStep, scene.world.getSolverInfo(), rows));
    CHECK(rows.empty());
}
