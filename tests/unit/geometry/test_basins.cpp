#include "support/catch.hpp"

#include "geometry/basin_query.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <algorithm>
#include <numbers>

using namespace flotsam;
namespace meshes = test_meshes;

namespace {

/// 1 x 0.6 x 0.4 m, its middle in the origin of the floor.
TriangleMesh boat(double thick = 0.01)
{
    return meshes::open_shell(Vec3d(-0.5, -0.3, 0), Vec3d(0.5, 0.3, 0.4), thick);
}

} // namespace

TEST_CASE("the inside of a boat is a basin as long as the water is below her rim", "[geometry][hydrostatics]")
{
    const TriangleMesh mesh = boat();
    const Pose pose{Vec3d(3, -2, 5), Quatd(Eigen::AngleAxisd(0.7, Vec3d::UnitZ()))};
    const auto count = [&](double level) {
        const std::vector<char> found = basins(mesh, pose, level);
        return std::count(found.begin(), found.end(), 1);
    };
    CHECK(count(5.0 - 0.1) == 0);
    CHECK(count(5.0 + 0.005) == 0); // in the planks of the floor
    CHECK(count(5.0 + 0.2) == 10);
    CHECK(count(5.0 + 0.39) == 10);
    CHECK(count(5.0 + 0.41) == 0);
    CHECK(meshes::volume(mesh) > 0.0);
    const std::vector<char> solid = basins(meshes::box({0, 0, 0}, {1, 1, 1}), Pose{}, 0.5);
    CHECK(std::count(solid.begin(), solid.end(), 1) == 0);
}

TEST_CASE("a boat has the draft of her outside", "[geometry][hydrostatics]")
{
    const TriangleMesh mesh = boat();
    const double load = GENERATE(0.001, 0.02, 0.1, 0.2, 0.239), from = GENERATE(0.05, 0.2, 0.39);
    CAPTURE(load, from);
    CHECK(vessel_draft(mesh, Pose{}, from, load).value() == Approx(load / 0.6).epsilon(1e-9));
    CHECK(vessel_draft(mesh, {Vec3d(0, 0, -1), Quatd::Identity()}, from - 1.0, load).value() ==
          Approx(load / 0.6).epsilon(1e-9));
}

TEST_CASE("a boat that is too heavy founders", "[geometry][hydrostatics]")
{
    CHECK_FALSE(vessel_draft(boat(), Pose{}, 0.2, 0.241).has_value());
    CHECK_FALSE(vessel_draft(boat(), Pose{}, 0.5, 0.241).has_value());
    CHECK_THROWS_AS(vessel_draft(boat(), Pose{}, 0.2, -1.0), std::invalid_argument);
}

TEST_CASE("a heeled boat, and a ball with a cavity, displace their hollows", "[geometry][hydrostatics]")
{
    // Heeled by 10 degrees the lower rim of a boat 0.6 m wide is 0.104 m lower than the other one.
    const double heel = 10.0 * std::numbers::pi / 180.0;
    const Pose pose{Vec3d::Zero(), Quatd(Eigen::AngleAxisd(heel, Vec3d::UnitX()))};
    const TriangleMesh outside = meshes::box(Vec3d(-0.5, -0.3, 0), Vec3d(0.5, 0.3, 0.4));
    const double exact = equilibrium_draft(outside, pose.orientation, 0.12).value();
    CHECK(vessel_draft(boat(), pose, 0.15, 0.12).value() == Approx(exact).epsilon(1e-9));

    const TriangleMesh solid = meshes::sphere(0.5, 30);
    const TriangleMesh ball = joined(solid, flipped(meshes::sphere(0.48, 30)));
    const double whole = meshes::volume(solid);
    CHECK(vessel_draft(ball, Pose{}, 0.1, 0.5 * whole).value() == Approx(0.5).epsilon(1e-6));
}

TEST_CASE("water comes to the outer surface alone", "[geometry][hydrostatics]")
{
    const TriangleMesh hull = meshes::box(Vec3d(-1, -1, -1), Vec3d(1, 1, 1));
    const TriangleMesh beside = meshes::box(Vec3d(2, 0, 0), Vec3d(3, 1, 1));
    const TriangleMesh cavity = flipped(meshes::box(Vec3d(-0.8, -0.8, -0.8), Vec3d(0.8, 0.8, 0.8)));
    const TriangleMesh ballast = meshes::box(Vec3d(-0.5, -0.5, -0.7), Vec3d(0.5, 0.5, -0.5));
    const TriangleMesh buoys = joined(joined(joined(hull, cavity), ballast), beside);
    CHECK(outer_surface(hull).triangles.size() == hull.triangles.size());
    CHECK(meshes::volume(outer_surface(joined(hull, beside))) == Approx(9.0));
    CHECK(meshes::volume(outer_surface(buoys)) == Approx(9.0));
    CHECK(meshes::volume(outer_surface(boat())) == Approx(meshes::volume(boat())));
}

TEST_CASE("what lies in a boat is told from what lies around her", "[geometry][hydrostatics]")
{
    const Pose pose{Vec3d(3, -2, 5), Quatd::Identity()};
    const BasinQuery query(boat(), pose, 5.2);
    REQUIRE_FALSE(query.empty());
    const auto holds = [&](double x, double y, double z) { return query.holds(pose.to_world(Vec3d(x, y, z))); };
    CHECK(holds(0, 0, 0.02));
    CHECK(holds(0.48, -0.28, 0.3));
    CHECK(holds(0.1, 0.1, 0.39)); // above the water, but below the rim
    CHECK_FALSE(holds(0, 0, 0.5));
    CHECK_FALSE(holds(0, 0, -0.02));
    CHECK_FALSE(holds(0.55, 0, 0.2));
    CHECK_FALSE(holds(0.495, 0, 0.2)); // in a plank
    const Vec3d inner = pose.to_world(Vec3d(0.49, 0.1, 0.2)), outer = pose.to_world(Vec3d(0.5, 0.1, 0.2));
    CHECK(query.holds(inner, 1e-3));
    CHECK_FALSE(query.holds(outer, 1e-3));
    CHECK(BasinQuery(boat(), pose, 5.5).empty());
    CHECK_FALSE(BasinQuery(boat(), pose, 5.5).holds(pose.position + Vec3d(0, 0, 0.2)));
}

TEST_CASE("in two dimensions a vessel has no ends", "[geometry][hydrostatics][2d]")
{
    const TriangleMesh whole = meshes::prism({{-0.3, 0.0}, {0.3, 0.0}, {0.3, 0.4}, {-0.3, 0.4}}, 0.5);
    CHECK(vessel_draft(hull_of(whole, 2), Pose{}, 0.1, 0.12).value() == Approx(0.2).epsilon(1e-9));
    const TriangleMesh shell = meshes::open_shell(Vec3d(-0.3, -2, 0), Vec3d(0.3, 2, 0.4), 0.01);
    const TriangleMesh hull = hull_of(shell, 2);
    CHECK_FALSE(BasinQuery(hull, Pose{}, 0.2).empty());
    CHECK(vessel_draft(hull, Pose{}, 0.1, 0.12).value() == Approx(0.2).epsilon(1e-9)); // a metre of it
}
