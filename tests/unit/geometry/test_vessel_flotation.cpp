#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/geometry/vessel_flotation.hpp"
#include "support/catch.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <limits>
#include <numbers>

using namespace flotsam;
namespace meshes = test_meshes;

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kThick = 0.01;

/// 1 x 0.6 x 0.4 m, her bottom at z = 0.
FloatingBody boat(double mass)
{
    return {meshes::open_shell(Vec3d(-0.5, -0.3, 0), Vec3d(0.5, 0.3, 0.4), kThick), mass, Vec3d(0, 0, 0.15)};
}

/// Of the same size, without a hollow.
FloatingBody block(double mass)
{
    return {meshes::box(Vec3d(-0.5, -0.3, 0), Vec3d(0.5, 0.3, 0.4)), mass, Vec3d(0, 0, 0.15)};
}

std::vector<double> degrees(double first, double step, double last)
{
    std::vector<double> angles;
    for (double angle = first; angle < last + 0.5 * step; angle += step) angles.push_back(angle * kDegree);
    return angles;
}

} // namespace

TEST_CASE("a boat whose hollow is dry floats like the block of her outside", "[geometry][hydrostatics]")
{
    const double heel = GENERATE(-25.0, 0.0, 10.0, 30.0) * kDegree, mass = GENERATE(40.0, 120.0);
    const Quatd turned(Eigen::AngleAxisd(heel, Vec3d::UnitX()));
    const auto dry = vessel_flotation(boat(mass), turned), solid = flotation(block(mass), turned);
    REQUIRE(dry.has_value());
    CHECK(dry->draft == Approx(solid->draft).epsilon(1e-10));
    CHECK(dry->submerged.volume == Approx(mass / 1000.0).epsilon(1e-12));
    CHECK((dry->submerged.center_of_buoyancy - solid->submerged.center_of_buoyancy).norm() < 1e-9);
    CHECK(dry->plane.area == Approx(solid->plane.area).epsilon(1e-9));
    CHECK(dry->metacentric_heights.heel == Approx(solid->metacentric_heights.heel).epsilon(1e-8));
    CHECK(dry->metacentric_heights.trim == Approx(solid->metacentric_heights.trim).epsilon(1e-8));
    CHECK((dry->righting_arms - solid->righting_arms).norm() < 1e-9);
    CHECK(dry->energy == Approx(solid->energy).epsilon(1e-9));
}

TEST_CASE("a boat is heeled until water comes over her rim", "[geometry][hydrostatics]")
{
    // At a draft of half her height the edge of her deck is at the water at atan(0.2 / 0.3) = 33.69 degrees; then the
    // water has the width of the rim to cross.
    const std::vector<double> angles = degrees(-60, 2.5, 60);
    const VesselArms dry = vessel_righting_arms(boat(120), Quatd::Identity(), angles);
    REQUIRE(dry.flooding_heel[0].has_value());
    REQUIRE(dry.flooding_heel[1].has_value());
    const double at = *dry.flooding_heel[1] / kDegree;
    CHECK(at > 33.69);
    CHECK(at < 36.0);
    CHECK(*dry.flooding_heel[0] / kDegree == Approx(-at).margin(1e-3));
    CHECK(dry.arms.size() == 27); // to 32.5 degrees
    const std::vector<RightingArm> solid = righting_arms(block(120), Quatd::Identity(), angles);
    for (const RightingArm& arm : dry.arms)
        for (const RightingArm& other : solid)
            if (other.heel == arm.heel) CHECK(arm.arm == Approx(other.arm).margin(1e-9));
}

TEST_CASE("a vessel's righting moment is the slope of her energy", "[geometry][hydrostatics]")
{
    const std::vector<double> angles = degrees(0, 0.01, 30);
    const VesselArms dry = vessel_righting_arms(boat(80), Quatd::Identity(), std::span(angles).subspan(1000, 3));
    REQUIRE(dry.arms.size() == 3);
    const double slope = (dry.arms[2].energy - dry.arms[0].energy) / (dry.arms[2].heel - dry.arms[0].heel);
    CHECK(slope == Approx(dry.arms[1].moment).epsilon(1e-5));
}

TEST_CASE("a light boat that is laid on her side takes water in", "[geometry][hydrostatics]")
{
    const double mass = GENERATE(2.0, 10.0);
    const VesselArms dry = vessel_righting_arms(boat(mass), Quatd::Identity(), degrees(0, 5, 180));
    REQUIRE(dry.flooding_heel[1].has_value());
    CHECK_FALSE(dry.flooding_heel[0].has_value());
    CHECK(*dry.flooding_heel[1] < 95.0 * kDegree); // the lighter one floats on the plank of her side
    CHECK(dry.arms.back().heel <= *dry.flooding_heel[1]);
}

TEST_CASE("a cavity is never flooded, and what has none floats as ever", "[geometry][hydrostatics]")
{
    const TriangleMesh ball = tessellate(SphereShape{0.5}, 0.1), cavity = flipped(tessellate(SphereShape{0.48}, 0.1));
    TriangleMesh hollow = ball;
    const int first = static_cast<int>(ball.vertices.size());
    hollow.vertices.insert(hollow.vertices.end(), cavity.vertices.begin(), cavity.vertices.end());
    for (const auto& t : cavity.triangles) hollow.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    const double mass = 400.0 * meshes::volume(ball);
    const FloatingBody sealed{hollow, mass, Vec3d(0, 0, -0.1)}, solid{ball, mass, Vec3d(0, 0, -0.1)};
    const std::vector<double> angles = degrees(-180, 45, 180);
    const VesselArms dry = vessel_righting_arms(sealed, Quatd::Identity(), angles);
    CHECK_FALSE(dry.flooding_heel[0].has_value());
    CHECK_FALSE(dry.flooding_heel[1].has_value());
    const VesselArms whole = vessel_righting_arms(solid, Quatd::Identity(), angles);
    const std::vector<RightingArm> exact = righting_arms(solid, Quatd::Identity(), angles);
    REQUIRE(dry.arms.size() == exact.size());
    REQUIRE(whole.arms.size() == exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k) {
        CHECK(dry.arms[k].arm == Approx(exact[k].arm).margin(1e-9));
        CHECK(whole.arms[k].arm == Approx(exact[k].arm).margin(1e-9));
    }
}

TEST_CASE("a boat that founders has no attitude, and no righting arms", "[geometry][hydrostatics]")
{
    const std::vector<double> angles = {0.1};
    CHECK_FALSE(vessel_flotation(boat(241), Quatd::Identity()).has_value());
    CHECK_THROWS_AS(vessel_righting_arms(boat(241), Quatd::Identity(), angles), std::invalid_argument);
    CHECK_THROWS_AS(vessel_righting_arms(boat(-1), Quatd::Identity(), angles), std::invalid_argument);
    const std::vector<double> endless = {std::numeric_limits<double>::infinity()};
    CHECK_THROWS_AS(vessel_righting_arms(boat(100), Quatd::Identity(), endless), std::invalid_argument);
}
