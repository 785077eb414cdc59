#include "flotsam/geometry/equilibrium_poses.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <algorithm>
#include <numbers>

using namespace flotsam;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

FloatingBody uniform(const TriangleMesh& mesh, double density_ratio)
{
    const MassProperties solid = mass_properties(mesh);
    return {mesh, 1000.0 * density_ratio * solid.volume, solid.center_of_mass};
}

EquilibriumPoses poses_of(const FloatingBody& body)
{
    const auto found = stable_poses(body);
    REQUIRE(found.has_value());
    CHECK(found->unconverged_starts == 0);
    for (const EquilibriumPose& pose : found->poses) {
        CHECK(pose.residual <= 1e-9);
        CHECK(pose.flotation.metacentric_heights.least > -1e-6);
    }
    return *found;
}

/// Tilt [deg] of a uniform square log of unit section from upright, 0 to 45. With t = tan(tilt), and the centre of mass
/// on the normal of the waterline through the centre of buoyancy: both sides cut (s <= 1/4): buoyancy at (t / 12 s, s/2
/// + t^2 / 24 s) from the bottom's middle, so t^2 = 12 s (1 - s) - 2; bottom and a side cut at a and b from their
/// corner: ab = 2 s and (a - b) (a + b - 3/2) = 0, so t = b/a with a, b = 3/4 +- sqrt(9/16 - 2 s), or a = b beyond s =
/// 9/32. Emerged and submerged change places for s > 1/2.
double log_tilt_deg(double s)
{
    s = std::min(s, 1.0 - s);
    if (s <= 0.25) return std::atan(std::sqrt(std::max(0.0, 12 * s * (1 - s) - 2))) / kDegree;
    const double root = std::sqrt(std::max(0.0, 9.0 / 16 - 2 * s));
    return std::atan((0.75 - root) / (0.75 + root)) / kDegree;
}

/// Closed prism along y over a regular polygon, stretched along x; of many corners, a cylinder.
TriangleMesh regular_prism(int corners, double radius, double length, double stretch = 1.0)
{
    std::vector<Eigen::Vector2d> outline;
    for (int k = 0; k < corners; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / corners;
        outline.emplace_back(stretch * radius * std::cos(angle), radius * std::sin(angle));
    }
    return test_meshes::prism(outline, 0.5 * length);
}

/// Tilt [deg] of the axis of a prism over a regular polygon whose ends the waterline does not cut: with the second
/// moment of the polygon's area R^2 (2 + cos(2 pi / n)) / 12 of that area, BM = that / (s L), BG = (1 - s) L / 2 and
/// the righting arm of wall sides (BM (1 + t^2 / 2) - BG) sin, t = tan(tilt), is nothing.
double prism_tilt_deg(int corners, double radius, double length, double s)
{
    const double moment = radius * radius * (2.0 + std::cos(2.0 * std::numbers::pi / corners)) / 12.0;
    const double bm = moment / (s * length), bg = 0.5 * (1.0 - s) * length;
    return std::atan(std::sqrt(2.0 * (bg / bm - 1.0))) / kDegree;
}

/// How far the body's `axis` leans from upright [deg], 0 to 180.
double lean_deg(const EquilibriumPose& pose, const Vec3d& axis)
{
    return std::acos((pose.flotation.pose.orientation * axis).z() / axis.norm()) / kDegree;
}

/// The angle to the nearest upright attitude of a square section [deg].
double from_upright(double heel_deg)
{
    return std::abs(std::remainder(heel_deg, 90.0));
}

} // namespace

TEST_CASE("a square log tilts as the closed form says", "[geometry][equilibrium]")
{
    CHECK(log_tilt_deg(0.25) == Approx(26.565).margin(1e-3));
    const double s =
        GENERATE(0.02, 0.1, 0.2, 0.211, 0.212, 0.22, 0.23, 0.24, 0.2499, 0.25, 0.2501, 0.26, 0.27, 0.28, 0.2812, 0.2813,
                 0.3, 0.4, 0.5, 0.6, 0.71, 0.7187, 0.7189, 0.725, 0.74, 0.75, 0.76, 0.78, 0.788, 0.789, 0.8, 0.95);
    INFO("density ratio " << s);
    const EquilibriumPoses found = poses_of(uniform(tessellate(BoxShape{{8, 1, 1}}, 1.0), s));
    const double tilt = log_tilt_deg(s);
    const bool is_between = tilt > 0.01 && tilt < 44.99;
    CHECK(found.poses.size() == (is_between ? 8 : 4));
    for (const EquilibriumPose& pose : found.poses) {
        CHECK(from_upright(pose.heel_deg) == Approx(tilt).margin(0.02)); // a fifth of what is asked of it
        CHECK(pose.trim_deg == Approx(0.0).margin(1e-4));
        if (std::abs(std::min(s, 1 - s) - 0.2113) > 0.001) CHECK(pose.neutral_directions == 0); // there it nearly is
    }
    CHECK(found.poses.back().flotation.energy ==
          Approx(found.poses.front().flotation.energy).epsilon(1e-10)); // all are mirror images
}

TEST_CASE("poses are returned in a fixed order, the lowest and the nearest to the model first",
          "[geometry][equilibrium]")
{
    const EquilibriumPoses flat = poses_of(uniform(tessellate(BoxShape{{1, 1, 0.4}}, 1.0), 0.3));
    REQUIRE(flat.poses.size() == 2); // upright and upside down
    CHECK(flat.poses[0].heel_deg == Approx(0.0).margin(1e-4));
    CHECK(flat.poses[1].heel_deg == Approx(180.0).margin(1e-4));
    CHECK(flat.poses[0].flotation.draft == Approx(0.12).epsilon(1e-9));

    FloatingBody loaded = uniform(tessellate(BoxShape{{1, 1, 0.4}}, 1.0), 0.3);
    loaded.center_of_mass.z() = 0.1; // higher one way up than the other
    const EquilibriumPoses found = poses_of(loaded);
    REQUIRE(found.poses.size() == 2);
    CHECK(found.poses[0].heel_deg == Approx(180.0).margin(1e-4));
    CHECK(found.poses[1].flotation.energy - found.poses[0].flotation.energy ==
          Approx(120.0 * 9.81 * 0.2).epsilon(1e-9));
}

TEST_CASE("a cube of a half floats corner up", "[geometry][equilibrium]")
{
    const EquilibriumPoses found = poses_of(uniform(tessellate(BoxShape{}, 1.0), 0.5));
    REQUIRE(found.poses.size() == 8);
    for (const EquilibriumPose& pose : found.poses) {
        const Vec3d up = pose.flotation.pose.orientation.conjugate() * Vec3d::UnitZ();
        CHECK((up.cwiseAbs() - Vec3d::Constant(1 / std::sqrt(3.0))).norm() < 1e-6);
        CHECK(pose.flotation.draft == Approx(std::sqrt(3.0) / 2).epsilon(1e-9));
    }
}

TEST_CASE("round bodies have families of poses, one of which is returned", "[geometry][equilibrium]")
{
    const EquilibriumPoses roller = poses_of(uniform(tessellate(CylinderShape{0.5, 3.0}, 0.1), 0.4));
    REQUIRE(roller.poses.size() == 1);
    CHECK(roller.poses[0].neutral_directions == 1);
    const Vec3d up = roller.poses[0].flotation.pose.orientation.conjugate() * Vec3d::UnitZ();
    CHECK(std::abs(up.z()) < 1e-6); // its axis lies

    const EquilibriumPoses ball = poses_of(uniform(tessellate(SphereShape{0.5}, 0.05), 0.4));
    REQUIRE(ball.poses.size() == 1);
    CHECK(ball.poses[0].neutral_directions == 2);

    FloatingBody weighted = uniform(tessellate(SphereShape{0.5}, 0.05), 0.4);
    weighted.center_of_mass = Vec3d(0.1, 0, 0);
    const EquilibriumPoses toy = poses_of(weighted); // stands up again
    REQUIRE(toy.poses.size() == 1);
    CHECK(toy.poses[0].neutral_directions == 0);
    CHECK(toy.poses[0].trim_deg == Approx(90.0).margin(0.5)); // +x down, up to facets
}

TEST_CASE("a drum tilts in a ring of poses", "[geometry][equilibrium]")
{
    // Upright is stable below a height of 0.71 diameters, lying above one.
    const EquilibriumPoses drum = poses_of(uniform(tessellate(CylinderShape{0.5, 0.85}, 0.05), 0.5));
    for (const EquilibriumPose& pose : drum.poses) {
        CHECK(pose.neutral_directions == 1);
        const Vec3d up = pose.flotation.pose.orientation.conjugate() * Vec3d::UnitZ();
        CHECK(std::abs(up.z()) > 0.2);
        CHECK(std::abs(up.z()) < 0.95);
    }
    CHECK(drum.poses.size() == 2); // one ring either way up
}

TEST_CASE("a cylinder that floats inclined has one family of poses for each end", "[geometry][equilibrium]")
{
    const int corners = GENERATE(12, 24, 48, 96);
    const bool is_turned = GENERATE(false, true);
    INFO(corners << " corners" << (is_turned ? ", turned" : ""));
    const Quatd turn = is_turned ? Quatd(0.8, 0.3, -0.2, 0.5).normalized() : Quatd::Identity();
    TriangleMesh mesh = regular_prism(corners, 0.2, 0.3);
    for (Vec3d& v : mesh.vertices) v = turn * v;
    const FloatingBody body = uniform(mesh, 0.5);
    const Vec3d axis = turn * Vec3d::UnitY();
    const double tilt = prism_tilt_deg(corners, 0.2, 0.3, 0.5);

    const EquilibriumPoses found = poses_of(body);
    REQUIRE(found.poses.size() == 2);
    for (const EquilibriumPose& pose : found.poses) {
        CHECK(pose.neutral_directions == 1);
        const double lean = lean_deg(pose, axis);
        CHECK(std::min(lean, 180.0 - lean) == Approx(tilt).margin(0.01));
    }
    CHECK(lean_deg(found.poses[0], axis) + lean_deg(found.poses[1], axis) == Approx(180.0).margin(0.02));

    const auto settled = settled_pose(body, Quatd(0.7, 0.1, 0.4, -0.2));
    REQUIRE(settled.has_value());
    CHECK(settled->neutral_directions == 1);
}

TEST_CASE("each way in which a cone floats is one family of poses", "[geometry][equilibrium]")
{
    const int corners = GENERATE(24, 96);
    const double ratio = GENERATE(0.5, 0.512); // tip down it leans by 14 to 16 and by 2 to 8 degrees
    const bool is_turned = GENERATE(false, true);
    INFO(corners << " corners, density ratio " << ratio << (is_turned ? ", turned" : ""));
    const Quatd turn = is_turned ? Quatd(0.8, 0.3, -0.2, 0.5).normalized() : Quatd::Identity();
    TriangleMesh mesh = test_meshes::cone(0.2, 0.4, corners);
    for (Vec3d& v : mesh.vertices) v = turn * v;
    const EquilibriumPoses found = poses_of(uniform(mesh, ratio));
    REQUIRE(found.poses.size() == 3); // tip down, tip up, on its side
    std::vector<double> leans;
    for (const EquilibriumPose& pose : found.poses) {
        CHECK(pose.neutral_directions == 1);
        leans.push_back(lean_deg(pose, turn * Vec3d::UnitZ()));
    }
    std::ranges::sort(leans);
    CHECK(leans[0] < 20.0);
    CHECK(leans[1] == Approx(90.0).margin(20.0));
    CHECK(leans[2] > 150.0);
}

TEST_CASE("a prism that is nearly round has as many families as its ridges part", "[geometry][equilibrium]")
{
    // Along the ring of an elliptic cylinder E goes up and down twice: by 4e-6 m g V^(1/3) for a stretch of 1e-4, which
    // does not count, by 4e-5 for 1e-3.
    const auto [stretch, families, neutral] =
        GENERATE(table<double, std::size_t, int>({{1.0001, 2, 1}, {1.001, 4, 1}, {1.01, 4, 0}}));
    const EquilibriumPoses found = poses_of(uniform(regular_prism(64, 0.2, 0.3, stretch), 0.5));
    CHECK(found.poses.size() == families);
    for (const EquilibriumPose& pose : found.poses) CHECK(pose.neutral_directions == neutral);
}

TEST_CASE("a cube that leans in a ring about each face has one pose for it", "[geometry][equilibrium]")
{
    // While the waterline cuts four faces only, E depends on tan(tilt), whatever the direction. The others: corner up.
    const EquilibriumPoses found = poses_of(uniform(tessellate(BoxShape{}, 1.0), GENERATE(0.212, 0.22, 0.78)));
    CHECK(found.poses.size() == 8 + 6);
    CHECK(std::ranges::count(found.poses, 1, &EquilibriumPose::neutral_directions) == 6);
    CHECK(std::ranges::count(found.poses, 0, &EquilibriumPose::neutral_directions) == 8);
}

TEST_CASE("prisms of few sides keep their poses apart", "[geometry][equilibrium]")
{
    struct Case {
        int sides;
        double length, ratio;
        std::size_t poses;
    };
    const Case c =
        GENERATE(Case{4, 1.0, 0.35, 4}, Case{6, 1.0, 0.2, 6}, Case{6, 1.0, 0.35, 12}, Case{6, 0.3, 0.35, 12},
                 Case{6, 1.0, 0.5, 6}, Case{8, 1.0, 0.35, 8}, Case{12, 1.0, 0.35, 12}, Case{12, 0.4, 0.5, 12});
    INFO(c.sides << " sides, length " << c.length << ", density ratio " << c.ratio);
    const EquilibriumPoses found = poses_of(uniform(regular_prism(c.sides, 0.2, c.length), c.ratio));
    CHECK(found.poses.size() == c.poses);
    for (const EquilibriumPose& pose : found.poses) CHECK(pose.neutral_directions == 0);
}

TEST_CASE("heel, trim and rotation vector name the same orientation", "[geometry][equilibrium]")
{
    for (const EquilibriumPose& pose : poses_of(uniform(tessellate(BoxShape{}, 1.0), 0.5)).poses) {
        const Quatd turn(Eigen::AngleAxisd(pose.trim_deg * kDegree, Vec3d::UnitY()) *
                         Eigen::AngleAxisd(pose.heel_deg * kDegree, Vec3d::UnitX()));
        const Quatd given = pose.flotation.pose.orientation;
        CHECK(turn.angularDistance(given) < 1e-9);
        const double angle = pose.rotation_deg.norm();
        REQUIRE(angle > 1.0);
        CHECK(Quatd(Eigen::AngleAxisd(angle * kDegree, pose.rotation_deg / angle)).angularDistance(given) < 1e-9);
    }
}

TEST_CASE("a body settles in the pose that lies downhill", "[geometry][equilibrium]")
{
    const FloatingBody log = uniform(tessellate(BoxShape{{8, 1, 1}}, 1.0), 0.25);
    const double start_deg = GENERATE(5.0, 20.0, 40.0, -10.0, 175.0);
    const Quatd yaw(Eigen::AngleAxisd(0.8, Vec3d::UnitZ()));
    const auto settled = settled_pose(log, yaw * Quatd(Eigen::AngleAxisd(start_deg * kDegree, Vec3d::UnitX())));
    REQUIRE(settled.has_value());
    const double expected = start_deg > 90.0 ? 180 - 26.565 : std::copysign(26.565, start_deg);
    CHECK(settled->heel_deg == Approx(expected).margin(0.01));
    CHECK(settled->residual <= 1e-9);
    // It did not yaw: its long axis still points where it did.
    const Vec3d along = settled->flotation.pose.orientation * Vec3d::UnitX();
    CHECK((along - yaw * Vec3d::UnitX()).norm() < 1e-6);
}

TEST_CASE("a body that balances on a saddle falls off it", "[geometry][equilibrium]")
{
    const FloatingBody log = uniform(tessellate(BoxShape{{8, 1, 1}}, 1.0), 0.5);
    const auto settled = settled_pose(log, Quatd::Identity());
    REQUIRE(settled.has_value());
    CHECK(std::abs(settled->heel_deg) == Approx(45.0).margin(0.01));
    const FloatingBody mast = uniform(tessellate(BoxShape{{0.1, 0.1, 3}}, 1.0), 0.25); // on its end: a top
    const auto fallen = settled_pose(mast, Quatd::Identity());
    REQUIRE(fallen.has_value());
    const Vec3d mast_axis = fallen->flotation.pose.orientation * Vec3d::UnitZ();
    CHECK(std::abs(mast_axis.z()) < 1e-6);
}

TEST_CASE("poses do not depend on unit of length, place of the origin or weight of the water",
          "[geometry][equilibrium]")
{
    const double scale = GENERATE(1e-3, 1.0, 1e3);
    TriangleMesh mesh = tessellate(BoxShape{{8, 1, 1}}, 1.0);
    for (Vec3d& v : mesh.vertices) v = scale * (v + Vec3d(30, -20, 10));
    FloatingBody body = uniform(mesh, 0.27);
    body.mass *= 1.25;
    body.water_density *= 1.25;
    const EquilibriumPoses found = poses_of(body);
    CHECK(found.poses.size() == 8);
    for (const EquilibriumPose& pose : found.poses)
        CHECK(from_upright(pose.heel_deg) == Approx(log_tilt_deg(0.27)).margin(0.01));
}

TEST_CASE("very light bodies and those that just float have poses as well", "[geometry][equilibrium]")
{
    const TriangleMesh box = tessellate(BoxShape{{1, 0.8, 0.4}}, 1.0);
    const double ratio = GENERATE(1e-5, 1e-3, 0.9999);
    const EquilibriumPoses found = poses_of(uniform(box, ratio));
    REQUIRE(found.poses.size() >= 2);
    CHECK(found.poses[0].flotation.draft == Approx(0.4 * ratio).epsilon(1e-6));
    CHECK(found.poses[0].heel_deg == Approx(0.0).margin(0.01));
}

TEST_CASE("a body heavier than water has no pose, wrong numbers are refused", "[geometry][equilibrium]")
{
    FloatingBody box = uniform(tessellate(BoxShape{}, 1.0), 1.001);
    CHECK_FALSE(stable_poses(box).has_value());
    CHECK_FALSE(settled_pose(box, Quatd::Identity()).has_value());
    box.mass = -1.0;
    CHECK_THROWS_AS(stable_poses(box), std::invalid_argument);
    CHECK_THROWS_AS(settled_pose(box, Quatd::Identity()), std::invalid_argument);
    CHECK(std::string(NoEquilibrium(0.125).what()).find("0.125") != std::string::npos);
}
