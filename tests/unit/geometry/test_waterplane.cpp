#include "flotsam/geometry/hydrostatics.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <numbers>

using namespace flotsam;

namespace {

constexpr double kPi = std::numbers::pi;

Pose at(double x, double y, double z, const Quatd& turn = Quatd::Identity())
{
    return {Vec3d(x, y, z), turn};
}

Eigen::Matrix2d diagonal(double xx, double yy)
{
    return Eigen::Vector2d(xx, yy).asDiagonal();
}

} // namespace

TEST_CASE("the waterplane of a box is a rectangle, wherever it floats", "[geometry][hydrostatics]")
{
    const Vec3d place = GENERATE(Vec3d(0, 0, 0), Vec3d(7, -4, 10), Vec3d(-300, 200, 1));
    const Waterplane plane =
        waterplane(tessellate(BoxShape{{2, 3, 1}}, 1.0), at(place.x(), place.y(), place.z()), place.z() - 0.2);
    CHECK(plane.area == Approx(6.0).epsilon(1e-13));
    CHECK((plane.centroid - place.head<2>()).norm() < 1e-12);
    CHECK((plane.second_moment - diagonal(3.0 * 8 / 12, 2.0 * 27 / 12)).norm() < 1e-12);
}

TEST_CASE("the waterplane's moments turn with the body", "[geometry][hydrostatics]")
{
    const Quatd yaw(Eigen::AngleAxisd(0.7, Vec3d::UnitZ()));
    const Eigen::Matrix2d turn = yaw.toRotationMatrix().topLeftCorner<2, 2>();
    const Waterplane plane = waterplane(tessellate(BoxShape{{2, 3, 1}}, 1.0), at(1, 2, 0, yaw), 0.1);
    const Eigen::Matrix2d expected = turn * diagonal(3.0 * 8 / 12, 2.0 * 27 / 12) * turn.transpose();
    REQUIRE(std::abs(expected(0, 1)) > 0.5);
    CHECK((plane.second_moment - expected).norm() < 1e-12);

    // Heeled by an angle that leaves deck and bottom dry and wet, the cut is longer by 1 / cos.
    const Quatd heel(Eigen::AngleAxisd(0.2, Vec3d::UnitX()));
    const Waterplane heeled = waterplane(tessellate(BoxShape{{2, 3, 1}}, 1.0), at(0, 0, 0, heel), 0.0);
    const double breadth = 3.0 / std::cos(0.2);
    CHECK(heeled.area == Approx(2.0 * breadth).epsilon(1e-13));
    CHECK((heeled.second_moment - diagonal(breadth * 8 / 12, 2.0 * std::pow(breadth, 3) / 12)).norm() < 1e-12);
}

TEST_CASE("faces and vertices in the water plane count as above it", "[geometry][hydrostatics]")
{
    const TriangleMesh box = tessellate(BoxShape{{2, 3, 1}}, 1.0);
    CHECK(waterplane(box, Pose{}, -0.5).area == 0.0); // it just touches
    const Waterplane covered = waterplane(box, Pose{}, 0.5);
    CHECK(covered.area == Approx(6.0).epsilon(1e-13));
    CHECK((covered.second_moment - diagonal(2.0, 4.5)).norm() < 1e-12);
    for (const double level : {-3.0, 0.5 + 1e-9, 4.0}) {
        const Waterplane none = waterplane(box, Pose{}, level);
        CHECK(none.area == 0.0);
        CHECK(none.centroid == Eigen::Vector2d::Zero());
        CHECK(none.second_moment == Eigen::Matrix2d::Zero());
    }
    // Through two edges of a cube, all of whose other vertices lie off the plane.
    const Quatd on_edge(Eigen::AngleAxisd(kPi / 4, Vec3d::UnitX()));
    const Waterplane diagonal_cut = waterplane(tessellate(BoxShape{}, 1.0), at(0, 0, 0, on_edge), 0.0);
    CHECK(diagonal_cut.area == Approx(std::sqrt(2.0)).epsilon(1e-13));
    CHECK(diagonal_cut.second_moment(1, 1) == Approx(std::pow(2.0, 1.5) / 12).epsilon(1e-13));
    // A step: the plane goes through a shelf that looks up, and through the shelf of an overhang.
    const TriangleMesh step =
        joined(tessellate(BoxShape{{2, 2, 1}}, 1.0), transformed(tessellate(BoxShape{}, 1.0), at(0, 0, 1)));
    CHECK(waterplane(step, Pose{}, 0.5).area == Approx(4.0).epsilon(1e-13));
    CHECK(waterplane(step, Pose{}, 0.5 + 1e-9).area == Approx(1.0).epsilon(1e-13));
}

TEST_CASE("both hulls of a catamaran count", "[geometry][hydrostatics]")
{
    const TriangleMesh hull = tessellate(BoxShape{{4, 0.5, 1}}, 1.0);
    const TriangleMesh both = joined(transformed(hull, at(0, 1, 0)), transformed(hull, at(0, -2, 0)));
    const Waterplane plane = waterplane(both, Pose{}, 0.0);
    CHECK(plane.area == Approx(4.0).epsilon(1e-13));
    CHECK((plane.centroid - Eigen::Vector2d(0, -0.5)).norm() < 1e-13);
    const double own = 4.0 * std::pow(0.5, 3) / 12, apart = 2.0 * 1.5 * 1.5; // each hull about its own axis, Steiner
    CHECK((plane.second_moment - diagonal(2 * 0.5 * 64 / 12, 2 * (own + apart))).norm() < 1e-12);
}

TEST_CASE("holes are taken off", "[geometry][hydrostatics]")
{
    // A box well: the inner box is a cavity that is open above and below the cut.
    const TriangleMesh outer = tessellate(BoxShape{{2, 2, 2}}, 1.0), inner = tessellate(BoxShape{{1, 1, 1}}, 1.0);
    const Waterplane plane = waterplane(joined(outer, flipped(transformed(inner, at(0.25, 0, 0)))), Pose{}, 0.1);
    CHECK(plane.area == Approx(3.0).epsilon(1e-13));
    CHECK((plane.centroid - Eigen::Vector2d(-0.25 / 3, 0)).norm() < 1e-13);
    CHECK(plane.second_moment(1, 1) == Approx(15.0 / 12).epsilon(1e-13));
    const double xx = 16.0 / 12 - (1.0 / 12 + 0.0625) - 3.0 * std::pow(0.25 / 3, 2);
    CHECK(plane.second_moment(0, 0) == Approx(xx).epsilon(1e-13));
}

TEST_CASE("round waterplanes converge to their closed forms", "[geometry][hydrostatics]")
{
    // Of order two: a quarter of the error with twice the segments; the finest one is below 1e-3.
    const auto cone_error = [](int corners) {
        const double r = 0.6; // of the waterplane at height 0.9
        const Waterplane plane = waterplane(test_meshes::cone(1.0, 1.5, corners), Pose{}, 0.9);
        CHECK(plane.area == Approx(kPi * r * r).epsilon(20.0 / corners / corners));
        return std::abs(plane.second_moment(0, 0) / (kPi * std::pow(r, 4) / 4) - 1.0);
    };
    CHECK(cone_error(200) < 1e-3);
    CHECK(cone_error(200) < 0.3 * cone_error(100));
    CHECK(cone_error(100) > 1e-5);

    const auto sphere_error = [](int rings) {
        const double r_sq = 1.0 - 0.3 * 0.3;
        const Waterplane plane = waterplane(test_meshes::sphere(1.0, rings), Pose{}, 0.3);
        return std::abs(plane.second_moment(1, 1) / (kPi * r_sq * r_sq / 4) - 1.0);
    };
    CHECK(sphere_error(160) < 1e-3);
    CHECK(sphere_error(160) < 0.5 * sphere_error(40)); // where the plane lies between two rings changes as well
}

TEST_CASE("the waterplane of a Wigley hull", "[geometry][hydrostatics]")
{
    const double L = 2.0, B = 0.4;
    const auto error = [&](int stations) {
        const Waterplane plane = waterplane(wigley_hull({L, B, 0.25}, stations, stations), Pose{}, 0.0);
        CHECK(plane.centroid.norm() < 1e-12);
        CHECK(plane.area == Approx(2.0 / 3.0 * L * B).epsilon(4.0 / stations / stations));
        return (plane.second_moment - diagonal(B * L * L * L / 30, 4.0 / 105 * L * B * B * B))
            .cwiseQuotient(Eigen::Matrix2d(diagonal(B * L * L * L / 30, 4.0 / 105 * L * B * B * B) +
                                           Eigen::Matrix2d::Constant(1e-300)))
            .diagonal()
            .norm();
    };
    CHECK(error(80) < 1e-3);
    CHECK(error(80) < 0.3 * error(40));
}
