#include "multibody_scene.hpp"
#include "support/catch.hpp"

#include <Eigen/Eigenvalues>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kStep = 0.004;
constexpr auto kJoints = {"r", "p", "s", "l", "rrr", "sprlf"};

Eigen::MatrixXd dense(const MultibodyMotion& motion)
{
    Eigen::MatrixXd matrix(6 * motion.size(), 6 * motion.size());
    for (int to = 0; to < motion.size(); ++to)
        for (int from = 0; from < motion.size(); ++from)
            matrix.block<6, 6>(6 * to, 6 * from) = motion.mobility().block(to, from);
    return matrix;
}

/// J H^-1 J^T by Bullet's own response in joint space.
Eigen::MatrixXd by_bullet(const MultibodyMotion& motion)
{
    const btMultiBody& body = motion.body();
    const int dofs = motion.kinematics().dofs();
    btAlignedObjectArray<btScalar> force, answer, numbers;
    btAlignedObjectArray<btVector3> vectors;
    Eigen::MatrixXd matrix(6 * motion.size(), 6 * motion.size());
    for (int column = 0; column < matrix.cols(); ++column) {
        force.resize(0);
        for (int k = 0; k < dofs; ++k)
            force.push_back(static_cast<btScalar>(motion.kinematics().jacobian_transposed(column / 6)(k, column % 6)));
        answer.resize(0);
        answer.resize(dofs, 0);
        body.calcAccelerationDeltasMultiDof(&force[0], &answer[0], numbers, vectors);
        Eigen::VectorXd velocity(dofs);
        for (int k = 0; k < dofs; ++k) velocity[k] = static_cast<double>(answer[k]);
        for (int link = 0; link < motion.size(); ++link) {
            const Twist twist = motion.kinematics().twist(link, velocity);
            matrix.block<6, 1>(6 * link, column) << twist.linear, twist.angular;
        }
    }
    return matrix;
}

} // namespace

TEST_CASE("the mobility of a multibody is Bullet's own response", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 6u)));
    const std::string joints = GENERATE(values<const char*>(kJoints));
    MultibodyScene scene;
    MultibodyMotion motion(add_random_multibody(scene, joints, GENERATE(false, true), random));
    motion.read(kStep, scene.gravity, false);
    const Eigen::MatrixXd mobility = dense(motion), expected = by_bullet(motion);
    REQUIRE(expected.norm() > 1e-3);
    CHECK((mobility - expected).norm() < kTolerance * expected.norm());
}

TEST_CASE("the mobility of a multibody is symmetric and positive semi-definite", "[bullet][property]")
{
    Random random(GENERATE(range(1u, 6u)));
    const std::string joints = GENERATE(values<const char*>(kJoints));
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, joints, GENERATE(false, true), random);
    MultibodyMotion motion(body);
    motion.read(kStep, scene.gravity, false);
    const Eigen::MatrixXd mobility = dense(motion);
    CHECK((mobility - mobility.transpose()).norm() <= 1e-15 * mobility.norm()); // in any precision of Bullet's
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(mobility);
    CHECK(eigen.eigenvalues().minCoeff() > -1e-14 * mobility.norm());
    const int free = body.getNumDofs() + (body.hasFixedBase() ? 0 : 6);
    const auto moving = (eigen.eigenvalues().array() > 1e-10 * mobility.norm()).count();
    CHECK(moving <= free);

    const std::vector<Wrench> impulses = random_impulses(motion.size(), random);
    std::vector<Twist> twists(impulses.size());
    motion.mobility().respond(impulses, twists);
    for (int to = 0; to < motion.size(); ++to) {
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (int from = 0; from < motion.size(); ++from) {
            Eigen::Matrix<double, 6, 1> impulse;
            impulse << impulses[static_cast<std::size_t>(from)].linear,
                impulses[static_cast<std::size_t>(from)].angular;
            sum += motion.mobility().block(to, from) * impulse;
        }
        CHECK(difference(twists[static_cast<std::size_t>(to)], {sum.head<3>(), sum.tail<3>()}) < 1e-12);
    }
}

TEST_CASE("a push on one link moves the others, and no fixed base", "[bullet]")
{
    Random random(2);
    MultibodyScene scene;
    const bool is_fixed = GENERATE(false, true);
    MultibodyMotion motion(add_random_multibody(scene, "rrr", is_fixed, random));
    motion.read(kStep, scene.gravity, false);
    CHECK(motion.mobility().responds(0) == !is_fixed);
    CHECK((motion.mobility().block(0, 3).norm() > 1e-3) == !is_fixed);
    for (int link = 1; link <= 3; ++link) {
        CHECK(motion.mobility().responds(link));
        CHECK(motion.mobility().block(link, 3).norm() > 1e-3);
    }
}

TEST_CASE("links that are fixed to each other answer as one rigid body", "[bullet][oracle]")
{
    MultibodyScene scene;
    auto made = std::make_unique<btMultiBody>(1, btScalar(2), btVector3(1, 1, 1), false, true);
    made->setupFixed(0, 1, btVector3(1, 1, 1), -1, btQuaternion::getIdentity(), btVector3(3, 0, 0), btVector3(0, 0, 0));
    MultibodyMotion motion(scene.add(std::move(made)));
    motion.read(kStep, scene.gravity, false);
    // 3 kg, 2 + 2 kg (1 m)^2 + 1 kg (2 m)^2 about y; pushed along z at its end, 2 m from the centre of mass
    const std::vector<Wrench> impulses{{}, {Vec3d::UnitZ(), Vec3d::Zero()}};
    std::vector<Twist> twists(2);
    motion.mobility().respond(impulses, twists);
    const double turning = -2.0 / 8.0;
    CHECK(difference(twists[0], {Vec3d(0, 0, 1.0 / 3.0 + turning), Vec3d(0, turning, 0)}) < kTolerance);
    CHECK(difference(twists[1], {Vec3d(0, 0, 1.0 / 3.0 - 2.0 * turning), Vec3d(0, turning, 0)}) < kTolerance);
}

TEST_CASE("what Bullet holds still is held still", "[bullet]")
{
    Random random(3);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "rr", false, random);
    body.getBaseCollider()->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    body.getLinkCollider(0)->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    MultibodyMotion motion(body);
    motion.read(kStep, scene.gravity, false);
    CHECK_FALSE(motion.mobility().responds(0));
    CHECK_FALSE(motion.mobility().responds(1));
    CHECK(motion.mobility().responds(2));
    CHECK((dense(motion) - by_bullet(motion)).norm() < kTolerance * dense(motion).norm());

    body.getLink(1).m_mass = 0; // next to nothing to turn
    body.getLink(1).m_inertiaLocal.setValue(btScalar(1e-17), btScalar(1e-17), btScalar(1e-17));
    motion.read(kStep, scene.gravity, false);
    CHECK_FALSE(motion.mobility().responds(2));
    CHECK(by_bullet(motion).norm() == 0.0);
}

TEST_CASE("a point mass on a ball joint, whose spin nothing resists, moves across its rod", "[bullet]")
{
    Random random(GENERATE(range(1u, 11u)));
    MultibodyScene scene;
    const Vec3d along = (Vec3d(0.2, 0.3, 2.0) + 0.1 * random.vector()).normalized();
    const btVector3 rod = to_bullet(0.3 * along), none(0, 0, 0);
    auto made = std::make_unique<btMultiBody>(1, btScalar(0), none, true, true);
    made->setupSpherical(0, 2, none, -1, btQuaternion::getIdentity(), none, rod);
    MultibodyMotion motion(scene.add(std::move(made)));
    motion.read(kStep, scene.gravity, false);
    const Mat3d expected = 0.5 * (Mat3d::Identity() - along * along.transpose());
    CHECK((motion.mobility().block(1, 1).topLeftCorner<3, 3>() - expected).norm() < kTolerance);
    CHECK(motion.mobility().block(1, 1).norm() < 1e6); // by rounding it were 1e14
}
