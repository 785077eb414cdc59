#include "support/catch.hpp"

#include "flotsam/geometry/volume_samples.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace flotsam;
namespace meshes = test_meshes;

namespace {

double smallest_gap(const std::vector<Vec3d>& points)
{
    double smallest_sq = 1e300;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) smallest_sq = std::min(smallest_sq, (points[i] - points[j]).squaredNorm());
    return std::sqrt(smallest_sq);
}

} // namespace

TEST_CASE("a box is filled with exactly its volume", "[geometry][volume_samples]")
{
    const double d = 0.05;
    const Vec3d size = GENERATE(Vec3d(0.5, 0.4, 0.3), Vec3d(0.53, 0.47, 0.333), Vec3d(0.98, 0.11, 0.21),
                                Vec3d(0.4, 0.04, 0.4), Vec3d(0.6, 0.6, 0.02), Vec3d(0.6, 0.6, 0.01));
    const Aabb box{Vec3d(-0.3, 2.0, 1.0), Vec3d(-0.3, 2.0, 1.0) + size};
    SECTION("3-D")
    {
        const std::vector<Vec3d> points = fill_box(box, d, 3);
        CHECK(points.size() == static_cast<std::size_t>(std::llround(size.prod() / (d * d * d))));
        for (const Vec3d& p : points) CHECK(box.contains(p));
        CHECK(smallest_gap(points) > 0.55 * d); // in the incomplete top layer of a box
    }
    SECTION("2-D")
    {
        const std::vector<Vec3d> points = fill_box(box, d, 2);
        CHECK(points.size() == static_cast<std::size_t>(std::llround(size.x() * size.z() / (d * d))));
        for (const Vec3d& p : points) {
            CHECK(p.y() == 0.0);
            CHECK(box.contains({p.x(), 2.0, p.z()}));
        }
    }
}

TEST_CASE("a box of whole spacings is filled with the plain lattice", "[geometry][volume_samples]")
{
    const double d = 0.1;
    const std::vector<Vec3d> points = fill_box({Vec3d::Zero(), Vec3d(0.4, 0.3, 0.2)}, d, 3);
    REQUIRE(points.size() == 24);
    CHECK((points.front() - Vec3d::Constant(0.05)).norm() < 1e-12);
    CHECK((points.back() - Vec3d(0.35, 0.25, 0.15)).norm() < 1e-12);
    CHECK(smallest_gap(points) == Approx(d));
}

TEST_CASE("the top layer is spread evenly", "[geometry][volume_samples]")
{
    const double d = 0.1;
    const std::vector<Vec3d> points = fill_box({Vec3d::Zero(), Vec3d(2.0, 2.0, 0.15)}, d, 3);
    REQUIRE(points.size() == 600);
    int quarters[4] = {0, 0, 0, 0};
    for (std::size_t k = 400; k < 600; ++k) {
        REQUIRE(points[k].z() > 0.1);
        ++quarters[(points[k].x() > 1.0 ? 1 : 0) + (points[k].y() > 1.0 ? 2 : 0)];
    }
    for (int quarter : quarters) CHECK(std::abs(quarter - 50) <= 5);
}

TEST_CASE("a mesh is filled with the lattice points inside", "[geometry][volume_samples]")
{
    const double d = 0.05;
    const int shape = GENERATE(0, 1, 2);
    const TriangleMesh mesh = shape == 0   ? meshes::sphere(0.5, 30)
                              : shape == 1 ? meshes::angle_bar(0.4, 0.3)
                                           : meshes::box({0, 0, 0}, {0.5, 0.25, 0.3});
    const SurfaceQuery query(mesh);
    const std::vector<Vec3d> points = fill_mesh(query, d, 3);
    const double wanted = meshes::volume(mesh) / (d * d * d);
    CHECK(static_cast<double>(points.size()) == Approx(wanted).epsilon(0.02)); // the surface cuts cells in two
    if (shape == 2) CHECK(points.size() == 300);
    for (const Vec3d& p : points) CHECK(query.inside(p));
    CHECK(smallest_gap(points) == Approx(d));

    // Nothing inside is left out: lattice neighbours of points are points, or outside.
    const auto is_point = [&](const Vec3d& p) {
        return std::any_of(points.begin(), points.end(), [&](const Vec3d& q) { return (p - q).norm() < 1e-6; });
    };
    for (std::size_t k = 0; k < points.size(); k += 37)
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3d next = points[k] + d * Vec3d::Unit(axis);
            if (query.closest(next).distance > 1e-6) CHECK(is_point(next) == query.inside(next));
        }
}

TEST_CASE("a mesh's cut is filled in two dimensions", "[geometry][volume_samples][2d]")
{
    const double d = 0.05;
    const SurfaceQuery disc(meshes::disc(0.5, 60)), bar(meshes::angle_bar(0.4, 0.5));
    const std::vector<Vec3d> in_disc = fill_mesh(disc, d, 2), in_bar = fill_mesh(bar, d, 2);
    CHECK(static_cast<double>(in_disc.size()) == Approx(0.25 * std::numbers::pi / (d * d)).epsilon(0.02));
    CHECK(in_bar.size() == 192);
    for (const Vec3d& p : in_disc) {
        CHECK(p.y() == 0.0);
        CHECK(disc.inside(p));
    }
}

TEST_CASE("fillings that make no sense are refused", "[geometry][volume_samples]")
{
    const Aabb box{Vec3d::Zero(), Vec3d::Ones()};
    CHECK_THROWS_AS(fill_box(box, 0.0, 3), std::invalid_argument);
    CHECK_THROWS_AS(fill_box(box, std::nan(""), 3), std::invalid_argument);
    CHECK_THROWS_AS(fill_box(box, 0.1, 4), std::invalid_argument);
    CHECK_THROWS_AS(fill_box(Aabb{}, 0.1, 3), std::invalid_argument);
    CHECK_THROWS_AS(fill_mesh(SurfaceQuery(meshes::sphere(1.0, 8)), -0.1, 3), std::invalid_argument);
    CHECK(fill_box({Vec3d::Zero(), Vec3d::Zero()}, 0.1, 3).empty());
}
