#include "bullet_scene.hpp"
#include "support/catch.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

using namespace flotsam;
using namespace flotsam::test;

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// The port's response to unit impulses.
Mat6 response(const BulletBodies& port)
{
    Mat6 matrix;
    for (int k = 0; k < 6; ++k) {
        std::vector<Wrench> impulse(1);
        std::vector<Twist> twist(1);
        (k < 3 ? impulse[0].linear[k] : impulse[0].angular[k - 3]) = 1.0;
        port.respond(impulse, twist);
        matrix.col(k) << twist[0].linear, twist[0].angular;
    }
    return matrix;
}

/// (F I F)^+ by the inverse of the block of axes that are free.
Mat3d constrained(const Mat3d& inertia, int free)
{
    std::vector<int> axes;
    for (int k = 0; k < 3; ++k)
        if (free & (1 << k)) axes.push_back(k);
    Mat3d mobility = Mat3d::Zero();
    if (axes.empty()) return mobility;
    const Eigen::MatrixXd block = inertia(axes, axes);
    const Eigen::MatrixXd inverse = block.inverse();
    mobility(axes, axes) = inverse;
    return mobility;
}

} // namespace

TEST_CASE("respond is linear, symmetric and positive semi-definite", "[bullet][property]")
{
    Random random(GENERATE(range(1u, 21u)));
    BulletScene scene;
    btRigidBody& body = add_random_body(scene, random);
    const auto factor = [&] { return random.number() < -0.3 ? 0.0 : random.number(0.0, 1.5); };
    const Vec3d linear(factor(), factor(), factor()), angular(factor(), factor(), factor());
    body.setLinearFactor(to_bullet(linear));
    body.setAngularFactor(to_bullet(angular));
    BulletBodies port(scene.world);
    port.add(body);
    std::vector<BodyState> states(1);
    port.read(0.004, states);

    const Mat6 y = response(port);
    REQUIRE(y.norm() > 0.0);
    CHECK((y - y.transpose()).norm() < 1e-12 * y.norm());
    const Eigen::SelfAdjointEigenSolver<Mat6> eigen(y);
    CHECK(eigen.eigenvalues().minCoeff() > (sizeof(btScalar) == 8 ? -1e-14 : -1e-6) * y.norm());

    const std::vector<Wrench> impulses{random.wrench()};
    std::vector<Twist> twists(1);
    port.respond(impulses, twists);
    Eigen::Matrix<double, 6, 1> stacked;
    stacked << impulses[0].linear, impulses[0].angular;
    const auto by_columns = (y * stacked).eval();
    CHECK(difference(twists[0], {by_columns.head<3>(), by_columns.tail<3>()}) < 1e-12);
}

TEST_CASE("locked rotation axes leave the inverse of the free block of the inertia", "[bullet][oracle]")
{
    const int free = GENERATE(range(0, 8));
    Random random(7);
    BulletScene scene;
    btRigidBody& body = add_random_body(scene, random);
    body.setAngularFactor(btVector3(btScalar(free & 1), btScalar((free >> 1) & 1), btScalar((free >> 2) & 1)));
    const Mat3d axes = from_bullet(body.getWorldTransform().getBasis());
    const Mat3d inertia = axes * from_bullet(body.getLocalInertia()).asDiagonal() * axes.transpose();
    REQUIRE(std::abs(inertia(0, 1)) > 1e-2); // not along the axes
    CHECK((mobility_of(body).angular - constrained(inertia, free)).norm() < kTolerance);
}

TEST_CASE("without locked axes respond is what Bullet's own impulses do", "[bullet][oracle]")
{
    Random random(5);
    BulletScene scene;
    btRigidBody& body = add_random_body(scene, random);
    const Wrench impulse = random.wrench();
    const Twist answer = mobility_of(body) * impulse, before = velocity(body);
    body.applyCentralImpulse(to_bullet(impulse.linear));
    body.applyTorqueImpulse(to_bullet(impulse.angular));
    CHECK(difference(velocity(body), {before.linear + answer.linear, before.angular + answer.angular}) < kTolerance);
}

TEST_CASE("a body without inertia about an axis does not turn about it", "[bullet]")
{
    BulletScene scene;
    auto& shape = scene.shape<btSphereShape>(btScalar(0.1));
    btRigidBody& body = scene.add({1, nullptr, &shape, btVector3(0, 2, 0)}); // 0 stands for infinite
    CHECK(mobility_of(body).angular.isApprox(Mat3d(Vec3d(0.0, 0.5, 0.0).asDiagonal())));
    body.setAngularFactor(btVector3(0, 1, 1));
    CHECK(mobility_of(body).angular.isApprox(Mat3d(Vec3d(0.0, 0.5, 0.0).asDiagonal())));
}
