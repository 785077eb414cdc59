#include "flotsam/geometry/flotation.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <limits>
#include <numbers>

using namespace flotsam;

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

FloatingBody uniform(const TriangleMesh& mesh, double density_ratio)
{
    const MassProperties solid = mass_properties(mesh);
    return {mesh, 1000.0 * density_ratio * solid.volume, solid.center_of_mass};
}

Flotation upright(const FloatingBody& body)
{
    const auto afloat = flotation(body, Quatd::Identity());
    REQUIRE(afloat.has_value());
    return *afloat;
}

} // namespace

TEST_CASE("a box floats with the textbook's metacentric heights", "[geometry][flotation]")
{
    const double ratio = GENERATE(0.05, 0.3, 0.5, 0.9);
    const double L = 3.0, B = 1.2, H = 0.7, draft = ratio * H;
    const Flotation afloat = upright(
        uniform(transformed(tessellate(BoxShape{{L, B, H}}, 1.0), Pose{Vec3d(5, 6, 7), Quatd::Identity()}), ratio));
    CHECK(afloat.draft == Approx(draft).epsilon(1e-12));
    CHECK(afloat.metacentric_heights.heel == Approx(draft / 2 + B * B / (12 * draft) - H / 2).epsilon(1e-11));
    CHECK(afloat.metacentric_heights.trim == Approx(draft / 2 + L * L / (12 * draft) - H / 2).epsilon(1e-11));
    CHECK(afloat.metacentric_heights.least == Approx(afloat.metacentric_heights.heel).epsilon(1e-11));
    CHECK(afloat.metacentric_heights.greatest == Approx(afloat.metacentric_heights.trim).epsilon(1e-11));
    CHECK(std::sin(afloat.metacentric_heights.least_axis) == Approx(0.0).margin(1e-9));
    CHECK((afloat.center_of_mass - Vec3d(0, 0, H / 2 - draft)).norm() < 1e-12);
    CHECK((afloat.submerged.center_of_buoyancy - Vec3d(0, 0, -draft / 2)).norm() < 1e-11);
    CHECK(afloat.energy == Approx(1000.0 * ratio * L * B * H * 9.81 * (H - draft) / 2).epsilon(1e-11));
    // The pose it returns is where it says that it floats.
    CHECK((afloat.pose.to_world(Vec3d(5, 6, 7)) - afloat.center_of_mass).norm() < 1e-12);
}

TEST_CASE("the principal axis of least stability is found", "[geometry][flotation]")
{
    const TriangleMesh box = tessellate(BoxShape{{3, 1, 0.5}}, 1.0);
    const double yaw = GENERATE(0.0, 0.4, 1.5, 2.8);
    const auto afloat = flotation(uniform(box, 0.5), Quatd(Eigen::AngleAxisd(yaw, Vec3d::UnitZ())));
    REQUIRE(afloat.has_value());
    const MetacentricHeights& gm = afloat->metacentric_heights;
    CHECK(gm.least == Approx(0.125 + 1.0 / (12 * 0.25) - 0.25).epsilon(1e-11));
    CHECK(gm.greatest == Approx(0.125 + 9.0 / (12 * 0.25) - 0.25).epsilon(1e-11));
    CHECK(std::sin(gm.least_axis - yaw) == Approx(0.0).margin(1e-9)); // it heels most easily about its length
    CHECK(gm.least_axis >= 0.0);
    CHECK(gm.least_axis < std::numbers::pi);
    const double c = std::cos(yaw), s = std::sin(yaw);
    CHECK(gm.heel == Approx(gm.least * c * c + gm.greatest * s * s).epsilon(1e-10));
}

TEST_CASE("metacentric heights change sign at the limits of stability", "[geometry][flotation]")
{
    const double ratio = GENERATE(0.1, 0.25, 0.5, 0.8);
    const double box_limit = std::sqrt(6 * ratio * (1 - ratio)), drum_limit = std::sqrt(8 * ratio * (1 - ratio));
    const auto box_height = [&](double breadth) {
        return upright(uniform(tessellate(BoxShape{{20, breadth, 1}}, 1.0), ratio)).metacentric_heights.least;
    };
    CHECK(box_height(box_limit * 0.9999) < 0.0);
    CHECK(box_height(box_limit * 1.0001) > 0.0);
    const auto drum_height = [&](double diameter) {
        const TriangleMesh drum = tessellate(CylinderShape{diameter / 2, 1.0}, 0.05 * diameter);
        return upright(uniform(drum, ratio)).metacentric_heights.least;
    };
    // The 64-gon of the circle's area has 5e-6 more of second moment.
    CHECK(drum_height(drum_limit * 0.999) < 0.0);
    CHECK(drum_height(drum_limit * 1.001) > 0.0);
}

TEST_CASE("a sphere's metacentre is its centre, a cone's is 3 r^2 / 4 h above buoyancy", "[geometry][flotation]")
{
    FloatingBody ball = uniform(test_meshes::sphere(0.5, 100), 0.3);
    ball.center_of_mass = Vec3d(0, 0, -0.2);
    CHECK(upright(ball).metacentric_heights.least == Approx(0.2).epsilon(1e-3)); // facets
    CHECK(upright(ball).metacentric_heights.greatest == Approx(0.2).epsilon(1e-3));

    FloatingBody cone = uniform(test_meshes::cone(1.0, 1.5, 200), 0.216); // 0.6 of the height: 0.216 of the volume
    const Flotation afloat = upright(cone);
    const double h = 0.9, r = 0.6;
    CHECK(afloat.draft == Approx(h).epsilon(1e-10));
    const double keel_to_metacentre = 0.75 * h + 0.75 * r * r / h;
    CHECK(afloat.metacentric_heights.heel == Approx(keel_to_metacentre - 0.75 * 1.5).epsilon(2e-3)); // facets
}

TEST_CASE("the righting arms of held boxes are the tabulated ones", "[geometry][flotation]")
{
    struct Row {
        double breadth;
        std::array<double, 6> arms; // at 5, 10, 15, 20, 30, 45 degrees
    };
    const Row row = GENERATE(Row{0.30, {0.010945, 0.022111, 0.033746, 0.045553, 0.052924, 0.047140}},
                             Row{0.20, {0.003654, 0.007415, 0.011404, 0.015761, 0.025259, 0.026517}},
                             Row{0.10, {-0.000721, -0.001402, -0.002002, -0.002473, -0.002778, 0.0}});
    const FloatingBody box = uniform(tessellate(BoxShape{{1.0, row.breadth, 0.10}}, 1.0), 0.5);
    const double sign = GENERATE(1.0, -1.0); // the box is symmetric: arms are odd in the heel
    std::vector<double> angles;
    for (const double deg : {5, 10, 15, 20, 30, 45}) angles.push_back(sign * deg * kDegree);
    const std::vector<RightingArm> curve = righting_arms(box, Quatd::Identity(), angles);
    REQUIRE(curve.size() == 6);
    for (std::size_t k = 0; k < 6; ++k) {
        INFO(angles[k] / kDegree << " degrees");
        CHECK(curve[k].heel == angles[k]);
        CHECK(curve[k].arm == Approx(sign * row.arms[k]).margin(1e-6)); // the table's digits
        CHECK(curve[k].moment == Approx(box.mass * 9.81 * curve[k].arm).margin(1e-12));
    }
}

TEST_CASE("a righting moment is the slope of the energy, an initial one the metacentric height",
          "[geometry][flotation]")
{
    FloatingBody hull = uniform(wigley_hull({2.0, 0.4, 0.25}, 20, 10), 0.45);
    hull.center_of_mass += Vec3d(0.03, 0.02, -0.05); // a list and a trim
    const Quatd upright_turn(Eigen::AngleAxisd(0.3, Vec3d(0.2, 0.1, 1.0).normalized()));
    const double step = 1e-4;
    for (const double heel : {-2.5, -0.4, 0.0, 0.15, 0.9, 2.0}) {
        const auto curve = righting_arms(hull, upright_turn, std::vector<double>{heel - step, heel, heel + step});
        const double slope = (curve[2].energy - curve[0].energy) / (2 * step);
        REQUIRE(std::abs(curve[1].moment) > 0.1);
        CHECK(curve[1].moment == Approx(slope).epsilon(1e-5).margin(1e-5)); // second order in the step

        const Quatd turned = Quatd(Eigen::AngleAxisd(heel, Vec3d::UnitX())) * upright_turn;
        const double growth = (curve[2].arm - curve[0].arm) / (2 * step);
        CHECK(flotation(hull, turned)->metacentric_heights.heel == Approx(growth).epsilon(1e-4).margin(1e-6));
    }
}

TEST_CASE("what cannot float is refused or sinks", "[geometry][flotation]")
{
    FloatingBody box = uniform(tessellate(BoxShape{}, 1.0), 0.5);
    const std::vector<double> level{0.0};
    box.mass = 1001.0;
    CHECK_FALSE(flotation(box, Quatd::Identity()).has_value());
    CHECK_THROWS_WITH(righting_arms(box, Quatd::Identity(), level), Catch::Contains("must float"));
    box.mass = 1000.0;
    CHECK(flotation(box, Quatd::Identity())->draft == Approx(1.0).epsilon(1e-12));
    for (const double wrong : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) {
        const auto refused = [&](double FloatingBody::*field) {
            FloatingBody body = uniform(tessellate(BoxShape{}, 1.0), 0.5);
            body.*field = wrong;
            CHECK_THROWS_AS(flotation(body, Quatd::Identity()), std::invalid_argument);
        };
        refused(&FloatingBody::mass);
        refused(&FloatingBody::water_density);
        refused(&FloatingBody::gravity);
    }
    box = uniform(tessellate(BoxShape{}, 1.0), 0.5);
    CHECK_THROWS_AS(flotation(box, Quatd(0, 0, 0, 0)), std::invalid_argument);
    CHECK_THROWS_AS(righting_arms(box, Quatd::Identity(), std::vector<double>{kNaN}), std::invalid_argument);
    box.center_of_mass.x() = kNaN;
    CHECK_THROWS_AS(flotation(box, Quatd::Identity()), std::invalid_argument);
    box = uniform(tessellate(BoxShape{}, 1.0), 0.5);
    box.mesh = flipped(box.mesh);
    CHECK_THROWS_WITH(flotation(box, Quatd::Identity()), Catch::Contains("normals outward"));
    CHECK_THROWS_AS(flotation(FloatingBody{{}, 1.0}, Quatd::Identity()), std::invalid_argument);
}
