#include "flotsam/geometry/equilibrium_poses.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "geometry/split_mix.hpp"
#include "support/catch.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <numbers>

using namespace flotsam;

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

Mat3d random_stretch(SplitMix& random)
{
    Mat3d stretch;
    do {
        for (int k = 0; k < 9; ++k) stretch(k / 3, k % 3) = 2.0 * random.uniform() - 1.0;
    } while (stretch.determinant() < 0.1);
    return stretch;
}

/// An ellipsoid or a box, askew.
TriangleMesh random_convex(SplitMix& random)
{
    TriangleMesh mesh = random.uniform() < 0.5 ? test_meshes::sphere(1.0, 6) : tessellate(BoxShape{{2, 2, 2}}, 1.0);
    const Mat3d stretch = random_stretch(random);
    const Vec3d shift = 3.0 * random.direction_about_z(-1.0);
    for (Vec3d& vertex : mesh.vertices) vertex = stretch * vertex + shift;
    return mesh;
}

/// A star-shaped body with spikes and dents.
TriangleMesh random_rugged(SplitMix& random)
{
    TriangleMesh mesh = test_meshes::sphere(1.0, 5);
    for (Vec3d& vertex : mesh.vertices) vertex *= 0.4 + random.uniform();
    const Mat3d stretch = random_stretch(random);
    for (Vec3d& vertex : mesh.vertices) vertex = stretch * vertex;
    return mesh;
}

TriangleMesh random_mesh(SplitMix& random, int k)
{
    return k % 2 == 0 ? random_convex(random) : random_rugged(random);
}

Quatd random_turn(SplitMix& random)
{
    return Quatd(Eigen::AngleAxisd(kTwoPi * random.uniform(), random.direction_about_z(-1.0)));
}

FloatingBody random_body(SplitMix& random, int k)
{
    FloatingBody body{random_mesh(random, k)};
    const MassProperties solid = mass_properties(body.mesh);
    body.mass = 1000.0 * solid.volume * (0.1 + 0.8 * random.uniform());
    body.center_of_mass = solid.center_of_mass + 0.2 * std::cbrt(solid.volume) * random.direction_about_z(-1.0);
    return body;
}

double energy(const FloatingBody& body, const Quatd& orientation)
{
    return flotation(body, orientation)->energy;
}

Quatd turned(const Quatd& orientation, const Vec3d& turn)
{
    return Quatd(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * orientation;
}

} // namespace

TEST_CASE("what is above the water and what is below are the whole body", "[hydrostatics][property]")
{
    SplitMix random(2024);
    const Quatd over(Eigen::AngleAxisd(std::numbers::pi, Vec3d::UnitX())); // y and z change sign
    for (int k = 0; k < 60; ++k) {
        const TriangleMesh mesh = random_mesh(random, k);
        const MassProperties solid = mass_properties(mesh);
        const Pose pose{random.direction_about_z(-1.0), random_turn(random)};
        const double level = pose.to_world(solid.center_of_mass).z() + 0.6 * (random.uniform() - 0.5);
        const Pose mirrored = Pose{Vec3d::Zero(), over} * pose;
        const Submerged below = submerged_part(mesh, pose, level), above = submerged_part(mesh, mirrored, -level);
        REQUIRE(below.volume > 0.01 * solid.volume);
        REQUIRE(above.volume > 0.01 * solid.volume);
        CHECK(below.volume + above.volume == Approx(solid.volume).epsilon(1e-12));
        const Vec3d moment = below.volume * below.center_of_buoyancy + above.volume * (over * above.center_of_buoyancy);
        CHECK((moment / solid.volume - pose.to_world(solid.center_of_mass)).norm() < 1e-12);

        const Waterplane plane = waterplane(mesh, pose, level), from_above = waterplane(mesh, mirrored, -level);
        REQUIRE(plane.area > 0.0);
        CHECK(from_above.area == Approx(plane.area).epsilon(1e-11));
        CHECK(from_above.centroid.x() == Approx(plane.centroid.x()).margin(1e-11));
        CHECK(from_above.centroid.y() == Approx(-plane.centroid.y()).margin(1e-11));
        CHECK(from_above.second_moment(0, 1) == Approx(-plane.second_moment(0, 1)).margin(1e-11));
        CHECK(from_above.second_moment(1, 1) == Approx(plane.second_moment(1, 1)).margin(1e-11));
    }
}

TEST_CASE("torque and metacentric heights are the energy's derivatives", "[hydrostatics][property]")
{
    SplitMix random(7);
    const double step = 1e-4;
    for (int k = 0; k < 40; ++k) {
        const FloatingBody body = random_body(random, k);
        const Quatd turn = random_turn(random);
        const Flotation afloat = *flotation(body, turn);
        const double weight = body.mass * body.gravity, size = std::cbrt(mass_properties(body.mesh).volume);
        const double angle = kTwoPi * random.uniform();
        const Vec3d axis(std::cos(angle), std::sin(angle), 0.0);
        const double ahead = energy(body, turned(turn, step * axis)), behind = energy(body, turned(turn, -step * axis));
        const double slope = (ahead - behind) / (2 * step) / weight;
        const double arm = afloat.righting_arms.dot(axis.head<2>());
        CHECK(slope == Approx(arm).margin(1e-6 * size)); // second order in the step; arms are a tenth of the size

        // The height about the axis is the slope of the arm about it.
        const auto arm_at = [&](double turn_by) {
            return flotation(body, turned(turn, turn_by * axis))->righting_arms.dot(axis.head<2>());
        };
        const MetacentricHeights& gm = afloat.metacentric_heights;
        const double from_least = angle - gm.least_axis;
        const double height =
            gm.least * std::pow(std::cos(from_least), 2) + gm.greatest * std::pow(std::sin(from_least), 2);
        CHECK((arm_at(step) - arm_at(-step)) / (2 * step) == Approx(height).margin(2e-3 * size)); // it has kinks
    }
}

TEST_CASE("the water does no work over a whole turn", "[hydrostatics][property]")
{
    SplitMix random(99);
    for (int k = 0; k < 12; ++k) {
        const FloatingBody body = random_body(random, k);
        const int rows = 2000;
        std::vector<double> angles;
        for (int row = 0; row < rows; ++row) angles.push_back(kTwoPi * row / rows);
        double work = 0.0, exchanged = 0.0;
        for (const RightingArm& row : righting_arms(body, random_turn(random), angles)) {
            work += row.moment * kTwoPi / rows;
            exchanged += std::abs(row.moment) * kTwoPi / rows;
        }
        REQUIRE(exchanged > 0.01 * body.mass * body.gravity * std::cbrt(mass_properties(body.mesh).volume));
        CHECK(std::abs(work) < 1e-6 * exchanged); // the sum's own error: arms are smooth but for their kinks
    }
}

TEST_CASE("no stable pose has a lower neighbour, and the lowest is the lowest of all", "[hydrostatics][property]")
{
    SplitMix random(5);
    for (int k = 0; k < 10; ++k) {
        const FloatingBody body = random_body(random, k);
        const EquilibriumPoses found = *stable_poses(body);
        REQUIRE_FALSE(found.poses.empty());
        CHECK(found.unconverged_starts == 0);
        const double noise = 1e-12 * body.mass * body.gravity;
        for (const EquilibriumPose& pose : found.poses) {
            CHECK(pose.residual <= 1e-9);
            for (int side = 0; side < 8; ++side) {
                const Vec3d axis(std::cos(kTwoPi * side / 8), std::sin(kTwoPi * side / 8), 0.0);
                CHECK(energy(body, turned(pose.flotation.pose.orientation, 0.01 * axis)) >
                      pose.flotation.energy - noise);
            }
        }
        for (int trial = 0; trial < 200; ++trial)
            CHECK(energy(body, random_turn(random)) > found.poses.front().flotation.energy - noise);
        // Whatever it is let go from, it settles in one of them.
        for (int trial = 0; trial < 20; ++trial) {
            const Vec3d up =
                settled_pose(body, random_turn(random))->flotation.pose.orientation.conjugate() * Vec3d::UnitZ();
            double nearest = 10.0;
            for (const EquilibriumPose& pose : found.poses)
                nearest = std::min(nearest, (pose.flotation.pose.orientation.conjugate() * Vec3d::UnitZ() - up).norm());
            CHECK(nearest < 0.01);
        }
    }
}
