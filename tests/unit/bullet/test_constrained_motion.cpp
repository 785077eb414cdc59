#include "bullet/constrained_motion.hpp"
#include "bullet_scene.hpp"
#include "support/catch.hpp"

#include <Eigen/Dense>

using namespace flotsam;
using namespace flotsam::test;

namespace {

Mat6d random_mobility(Random& random)
{
    Mat6d root;
    for (int k = 0; k < 36; ++k) root(k / 6, k % 6) = random.number();
    return root * root.transpose() + 0.1 * Mat6d::Identity();
}

Vec6d random_six(Random& random)
{
    Vec6d v;
    for (int k = 0; k < 6; ++k) v[k] = random.number();
    return v;
}

Twist random_twist(Random& random)
{
    const Vec3d linear = random.vector(), angular = random.vector();
    return {linear, angular};
}

std::vector<Wrench> random_wrenches(Random& random, std::size_t count)
{
    std::vector<Wrench> wrenches;
    for (std::size_t k = 0; k < count; ++k) wrenches.push_back(random.wrench());
    return wrenches;
}

std::vector<Twist> answers(const ConstrainedMotion& motion, std::span<const Wrench> impulses)
{
    std::vector<Twist> twists(motion.bodies());
    motion.respond(impulses, twists);
    return twists;
}

/// At the end of the step.
std::vector<Twist> ends(const ConstrainedMotion& motion, std::span<const Wrench> impulses)
{
    std::vector<Twist> twists = answers(motion, impulses);
    for (std::size_t k = 0; k < twists.size(); ++k) {
        twists[k].linear += motion.predicted()[k].linear;
        twists[k].angular += motion.predicted()[k].angular;
    }
    return twists;
}

double work(std::span<const Wrench> impulses, std::span<const Twist> twists)
{
    double sum = 0.0;
    for (std::size_t k = 0; k < twists.size(); ++k)
        sum += impulses[k].linear.dot(twists[k].linear) + impulses[k].angular.dot(twists[k].angular);
    return sum;
}

/// A cube of 1 kg that falls onto the ground with its four lower corners; friction 0.5.
void put_cube_on_ground(ConstrainedMotion& motion, double fall, double aside)
{
    motion.clear();
    Mat6d mobility = Mat6d::Identity();
    mobility.bottomRightCorner<3, 3>() *= 6.0; // edges of 1 m
    motion.add_body({Vec3d(aside, 0, -fall), Vec3d::Zero()}, mobility);
    const auto row = [](const Vec3d& arm, const Vec3d& direction) {
        ConstraintRow made;
        made.a = 0;
        made.jacobian_a << direction, arm.cross(direction);
        return made;
    };
    for (const double x : {-0.5, 0.5}) {
        for (const double y : {-0.5, 0.5}) {
            ConstraintRow normal = row(Vec3d(x, y, -0.5), Vec3d::UnitZ());
            normal.lower = 0.0;
            motion.add_row(normal);
        }
    }
    for (const Vec3d& direction : {Vec3d(Vec3d::UnitX()), Vec3d(Vec3d::UnitY())}) {
        ConstraintRow friction = row(Vec3d(0, 0, -0.5), direction);
        friction.normal = 0;
        friction.normals = 4;
        friction.friction = 0.5;
        motion.add_row(friction);
    }
}

} // namespace

TEST_CASE("bodies under joints answer as the saddle-point system of all of them says", "[constraints][oracle]")
{
    Random random(GENERATE(range(1u, 6u)));
    const std::size_t bodies = 4;
    ConstrainedMotion motion;
    motion.clear();
    Eigen::MatrixXd mobility = Eigen::MatrixXd::Zero(24, 24);
    Eigen::VectorXd free(24);
    for (std::size_t k = 0; k < bodies; ++k) {
        const Mat6d own = random_mobility(random);
        const Twist twist = random_twist(random);
        motion.add_body(twist, own);
        mobility.block<6, 6>(6 * Eigen::Index(k), 6 * Eigen::Index(k)) = own;
        free.segment<6>(6 * Eigen::Index(k)) << twist.linear, twist.angular;
    }
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(7, 24);
    Eigen::VectorXd target(7);
    for (int r = 0; r < 7; ++r) {
        ConstraintRow row;
        row.a = r % 4;
        row.b = r < 4 ? (r + 1) % 4 : -1;
        row.jacobian_a = random_six(random);
        row.jacobian_b = random_six(random);
        row.target = random.number();
        motion.add_row(row);
        J.block<1, 6>(r, 6 * row.a) = row.jacobian_a.transpose();
        if (row.b >= 0) J.block<1, 6>(r, 6 * row.b) = row.jacobian_b.transpose();
        target[r] = row.target;
    }
    const std::vector<Wrench> impulses = random_wrenches(random, bodies);
    REQUIRE(motion.solve(impulses, 1e-7));

    Eigen::VectorXd w(24);
    for (std::size_t k = 0; k < bodies; ++k)
        w.segment<6>(6 * Eigen::Index(k)) << impulses[k].linear, impulses[k].angular;
    const Eigen::VectorXd without = free + mobility * w;
    const Eigen::VectorXd lambda = (J * mobility * J.transpose()).ldlt().solve(target - J * without);
    const Eigen::VectorXd exact = without + mobility * J.transpose() * lambda;
    const std::vector<Twist> got = ends(motion, impulses);
    for (std::size_t k = 0; k < bodies; ++k) {
        const Eigen::Index at = 6 * Eigen::Index(k);
        CHECK((got[k].linear - exact.segment<3>(at)).norm() < 1e-5); // the rows' matrix is regularised
        CHECK((got[k].angular - exact.segment<3>(at + 3)).norm() < 1e-5);
    }
}

TEST_CASE("the response under joints and contacts is symmetric, takes energy from nobody and has its own blocks",
          "[constraints][property]")
{
    Random random(GENERATE(range(1u, 6u)));
    ConstrainedMotion motion;
    motion.clear();
    for (int k = 0; k < 3; ++k) motion.add_body(random_twist(random), random_mobility(random));
    Eigen::MatrixXd root(12, 12); // two bodies that share a mobility
    for (Eigen::Index k = 0; k < root.size(); ++k) root(k / 12, k % 12) = random.number();
    const std::vector<Twist> pair{random_twist(random), random_twist(random)};
    motion.add_bodies(pair, root * root.transpose());
    for (int r = 0; r < 8; ++r) {
        ConstraintRow row;
        row.a = r % 5;
        row.b = (r + 2) % 5;
        row.jacobian_a = random_six(random);
        row.jacobian_b = random_six(random);
        row.target = random.number();
        if (r % 2 == 0) row.lower = 0.0;
        motion.add_row(row);
    }
    REQUIRE(motion.solve(random_wrenches(random, 5), 1e-7));
    const std::vector<Wrench> a = random_wrenches(random, 5), b = random_wrenches(random, 5);
    const double ab = work(a, answers(motion, b)), ba = work(b, answers(motion, a));
    CHECK(ab == Approx(ba).epsilon(1e-9).margin(1e-9));
    CHECK(work(a, answers(motion, a)) >= -1e-9);
    for (std::size_t k = 0; k < 5; ++k) {
        const Mat6d own = motion.own_mobility(k);
        for (int c = 0; c < 6; ++c) {
            std::vector<Wrench> unit(5);
            (c < 3 ? unit[k].linear[c] : unit[k].angular[c - 3]) = 1.0;
            const Twist answer = answers(motion, unit)[k];
            CHECK((own.col(c).head<3>() - answer.linear).norm() < 1e-8);
            CHECK((own.col(c).tail<3>() - answer.angular).norm() < 1e-8);
        }
    }
}

TEST_CASE("contacts push and do not pull, and yield where the impulses say so", "[constraints]")
{
    ConstrainedMotion motion;
    put_cube_on_ground(motion, 1.0, 0.0);
    const std::vector<Wrench> nothing(1), lift{{Vec3d(0, 0, 3), Vec3d::Zero()}},
        part{{Vec3d(0, 0, 0.4), Vec3d::Zero()}};
    REQUIRE(motion.solve(nothing, 1e-7));
    CHECK(ends(motion, nothing)[0].linear.norm() < 1e-6);
    CHECK(motion.holds(part, 1e-6)); // it lies more lightly
    CHECK(ends(motion, part)[0].linear.norm() < 1e-6);
    CHECK_FALSE(motion.holds(lift, 1e-6));
    REQUIRE(motion.solve(lift, 1e-7));
    CHECK((ends(motion, lift)[0].linear - Vec3d(0, 0, 2)).norm() < 1e-9);
    CHECK_FALSE(motion.holds(nothing, 1e-6));
}

TEST_CASE("friction holds up to its share of the normal impulse, then slides", "[constraints]")
{
    const std::vector<Wrench> nothing(1);
    ConstrainedMotion slow, fast;
    put_cube_on_ground(slow, 1.0, 0.3);
    REQUIRE(slow.solve(nothing, 1e-7));
    CHECK(ends(slow, nothing)[0].linear.norm() < 1e-6);
    put_cube_on_ground(fast, 1.0, 0.8);
    static_cast<void>(fast.solve(nothing, 1e-7));
    const Twist end = ends(fast, nothing)[0];
    CHECK(end.linear.x() == Approx(0.3).margin(0.02)); // 0.8 - 0.5 of the normal impulse
    CHECK(std::abs(end.linear.z()) < 1e-3);
}

TEST_CASE("rows without bodies, and bodies without rows, do no harm", "[constraints]")
{
    ConstrainedMotion motion;
    motion.clear();
    CHECK(motion.solve({}, 1e-7));
    Random random(1);
    const Twist twist = random_twist(random);
    motion.add_body(twist, random_mobility(random));
    motion.add_row({}); // between nothing and nothing
    const std::vector<Wrench> nothing(1);
    CHECK(motion.solve(nothing, 1e-7));
    CHECK(difference(motion.predicted()[0], twist) == 0.0);
}

namespace {

/// Steps with small random impulses on the coupled bodies; the largest differences of what the port promised and what
/// Bullet did, per body.
std::vector<double> differences(BulletScene& scene, BulletBodies& port, int steps)
{
    constexpr double dt = 0.004;
    Random random(5);
    std::vector<double> most(port.size());
    std::vector<BodyState> states(port.size());
    std::vector<Twist> answers(port.size());
    for (int k = 0; k < steps; ++k) {
        std::vector<Wrench> impulses(port.size());
        for (Wrench& impulse : impulses) impulse = random.wrench() * (0.2 * dt);
        port.read(dt, states);
        port.revise(impulses, states);
        port.respond(impulses, answers);
        port.apply(impulses);
        scene.step(dt);
        for (std::size_t body = 0; body < port.size() && k > 20; ++body) { // contacts are seen a step late at first
            const Twist promised{states[body].predicted.linear + answers[body].linear,
                                 states[body].predicted.angular + answers[body].angular};
            most[body] = std::max(most[body], difference(promised, velocity(port.body(static_cast<int>(body)))));
        }
    }
    return most;
}

} // namespace

TEST_CASE("joints, limits and motors of Bullet come out as Bullet's solver has them", "[constraints][oracle]")
{
    const bool has_motor = GENERATE(false, true), has_limit = GENERATE(false, true);
    BulletScene scene;
    scene.world.getSolverInfo().m_numIterations = 500;
    btRigidBody& swing = scene.add_box(1.5, Vec3d(3, 0, 2));
    btRigidBody& known_to_bullet_only = scene.add_box(1.0, Vec3d(3.4, 0, 2));
    btHingeConstraint hinge(swing, btVector3(0, 0, btScalar(0.3)), btVector3(0, 1, 0));
    btPoint2PointConstraint ball(swing, known_to_bullet_only, btVector3(btScalar(0.2), 0, 0),
                                 btVector3(btScalar(-0.2), 0, 0));
    if (has_motor) hinge.enableAngularMotor(true, btScalar(1.0), btScalar(0.002));
    if (has_limit) hinge.setLimit(btScalar(-0.02), btScalar(0.02), 1, 1, 0);
    scene.world.addConstraint(&hinge, true);
    scene.world.addConstraint(&ball, true);
    BulletBodies port(scene.world);
    port.add(swing);
    const double most = differences(scene, port, 150)[0];
    REQUIRE(std::abs(hinge.getHingeAngle()) > btScalar(1e-3)); // it hangs over to one side
    CHECK(most < (sizeof(btScalar) == 8 ? 1e-4 : 2e-3));       // of 0.04 m/s that gravity gives in a step
    scene.world.removeConstraint(&hinge);
    scene.world.removeConstraint(&ball);
}

TEST_CASE("bodies that lie on each other are held by their contacts", "[constraints]")
{
    BulletScene scene;
    scene.world.getSolverInfo().m_numIterations = 100;
    auto& ground = scene.shape<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
    scene.add({0, nullptr, &ground});
    btRigidBody& lower = scene.add_box(2.0, Vec3d(0, 0, 0.25));
    btRigidBody& upper = scene.add_box(1.0, Vec3d(0.02, 0, 0.75));
    BulletBodies port(scene.world);
    port.add(lower);
    port.add(upper);
    const std::vector<double> most = differences(scene, port, 100);
    REQUIRE(upper.getWorldTransform().getOrigin().z() > btScalar(0.74)); // still on top
    // Bullet finds new points of contact in each step, and rocks the boxes on them by as much.
    for (const double difference : most) CHECK(difference < 0.3);
    std::vector<BodyState> states(2);
    port.read(0.004, states);
    for (const BodyState& state : states) CHECK(state.predicted.linear.norm() < 0.02); // a free one: 0.04
    std::vector<Twist> answers(2);
    port.respond(std::vector<Wrench>{{Vec3d(0, 0, -0.1), Vec3d::Zero()}, {}}, answers);
    CHECK(answers[0].linear.norm() < 1e-4); // 0.05 without the ground
}
