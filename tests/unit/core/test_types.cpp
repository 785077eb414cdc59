#include "flotsam/core/types.hpp"
#include "support/catch.hpp"

#include <numbers>

using namespace flotsam;

namespace {

constexpr double kRounding = 1e-14; // of numbers around 1 after a few operations

Quatd turn(double degrees, const Vec3d& axis)
{
    return Quatd(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()));
}

} // namespace

TEST_CASE("a pose takes points to the world and back", "[core]")
{
    const Pose pose{Vec3d(1, 2, 3), turn(90.0, Vec3d::UnitZ())};
    CHECK((pose.to_world(Vec3d(1, 0, 0)) - Vec3d(1, 3, 3)).norm() < kRounding);
    const Vec3d point(0.3, -0.7, 0.2);
    CHECK((pose.to_body(pose.to_world(point)) - point).norm() < kRounding);
    CHECK((Pose().to_world(point) - point).norm() == 0.0);
}

TEST_CASE("the product of poses places the inner one in the outer one", "[core]")
{
    const Pose outer{Vec3d(1, 2, 3), turn(50.0, Vec3d(1, 2, 0))}, inner{Vec3d(-1, 0, 1), turn(20.0, Vec3d(0, 1, 3))};
    const Vec3d point(0.3, -0.7, 0.2);
    CHECK(((outer * inner).to_world(point) - outer.to_world(inner.to_world(point))).norm() < kRounding);
    CHECK((outer * inner).orientation.norm() == Approx(1.0));
}

TEST_CASE("a twist moves a point as a rigid body does", "[core]")
{
    const Twist twist{Vec3d(1, 0, 0), Vec3d(0, 0, 2)};
    CHECK((twist.at(Vec3d::Zero()) - Vec3d(1, 0, 0)).norm() == 0.0);
    CHECK((twist.at(Vec3d(1, 0, 0)) - Vec3d(1, 2, 0)).norm() == 0.0);
    // The finite difference of a pose that the twist carries on, to second order in dt.
    const double dt = 1e-4;
    const Vec3d arm(0.2, 0.5, -0.3);
    const Pose later{dt * twist.linear, Quatd(Eigen::AngleAxisd(dt * 2.0, Vec3d::UnitZ()))};
    CHECK(((later.to_world(arm) - arm) / dt - twist.at(arm)).norm() < 2.0 * dt);
}

TEST_CASE("wrenches add up and scale", "[core]")
{
    Wrench sum{Vec3d(1, 2, 3), Vec3d(4, 5, 6)};
    sum += Wrench{Vec3d(1, 0, 0), Vec3d(0, 1, 0)} * 2.0;
    CHECK(sum.linear == Vec3d(3, 2, 3));
    CHECK(sum.angular == Vec3d(4, 7, 6));
}

TEST_CASE("a wrench does on a twist the work of its forces on their points", "[core]")
{
    const Twist twist{Vec3d(0.1, -0.2, 0.3), Vec3d(1, 2, -1)};
    Wrench wrench;
    double work = 0.0;
    for (const Vec3d& arm : {Vec3d(1, 0, 0), Vec3d(0.2, 0.3, -0.4), Vec3d(0, -1, 2)}) {
        const Vec3d force = Vec3d(0.5, 1, 2) + arm.cwiseAbs2();
        wrench += {force, arm.cross(force)};
        work += force.dot(twist.at(arm));
    }
    CHECK(wrench.linear.dot(twist.linear) + wrench.angular.dot(twist.angular) == Approx(work));
}

TEST_CASE("a box knows what it holds", "[core]")
{
    Aabb box;
    CHECK(box.empty());
    box.extend(Vec3d(1, 2, 3));
    CHECK_FALSE(box.empty());
    box.extend(Vec3d(-1, 0, 3));
    CHECK(box.size() == Vec3d(2, 2, 0));
    CHECK(box.center() == Vec3d(0, 1, 3));
    CHECK(box.contains(Vec3d(-1, 2, 3)));
    CHECK_FALSE(box.contains(Vec3d(0, 1, 3.1)));
    CHECK(box.inflated(0.2).contains(Vec3d(0, 1, 3.1)));
    CHECK(box.inflated(-0.1).empty());
}
