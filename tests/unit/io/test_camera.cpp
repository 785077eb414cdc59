#include "support/catch.hpp"

#include "flotsam/io/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace flotsam;

namespace {

/// Largest distance of a box corner from the picture's centre, in half widths or half heights; < 1: all is seen.
double farthest_corner(const Camera& camera, const Aabb& box, double aspect)
{
    const Vec3d forward = (camera.look_at - camera.position).normalized();
    const Vec3d right = forward.cross(camera.up).normalized();
    const Vec3d up = right.cross(forward);
    const double half = std::tan(0.5 * camera.field_of_view_deg * std::numbers::pi / 180.0);
    double farthest = 0.0;
    for (int k = 0; k < 8; ++k) {
        const Vec3d corner((k & 1) ? box.max.x() : box.min.x(), (k & 2) ? box.max.y() : box.min.y(),
                           (k & 4) ? box.max.z() : box.min.z());
        const Vec3d arm = corner - camera.position;
        REQUIRE(arm.dot(forward) > 0.0);
        const double scale = half * arm.dot(forward);
        farthest = std::max({farthest, std::abs(arm.dot(right)) / (aspect * scale), std::abs(arm.dot(up)) / scale});
    }
    return farthest;
}

} // namespace

TEST_CASE("the default camera fills the picture with the contents", "[io][camera]")
{
    const double aspect = GENERATE(0.5, 1.0, 16.0 / 9.0, 4.0);
    const int dimensions = GENERATE(2, 3);
    const Aabb box =
        GENERATE(Aabb{{0, 0, 0}, {1, 1, 1}}, Aabb{{-50, 3, 2}, {50, 4, 3}}, Aabb{{0, 0, 0}, {0.01, 0.02, 5}});
    const double farthest = farthest_corner(default_camera(box, aspect, dimensions), box, aspect);
    CHECK(farthest < 1.0);
    CHECK(farthest > 0.9); // a margin, no more
}

TEST_CASE("the default camera looks down in 3-D and straight in 2-D", "[io][camera]")
{
    const Aabb box{{0, 0, 0}, {2, 1, 1}};
    const Camera three = default_camera(box, 1.5);
    CHECK(three.position.z() > box.max.z());
    CHECK(three.position.y() < box.min.y());
    const Camera two = default_camera(box, 1.5, 2);
    CHECK((two.look_at - two.position).normalized().isApprox(Vec3d::UnitY()));
    CHECK(two.field_of_view_deg < 10.0); // a long lens
}

TEST_CASE("a camera can look straight down or at nothing", "[io][camera]")
{
    const Aabb box{{0, 0, 0}, {2, 1, 1}};
    CHECK(farthest_corner(fitted_camera(box, 1.0, -Vec3d::UnitZ()), box, 1.0) < 1.0);
    const Camera at_nothing = default_camera(Aabb{}, 1.0);
    CHECK(at_nothing.position.allFinite());
    const Camera at_point = default_camera(Aabb{Vec3d::Ones(), Vec3d::Ones()}, 1.0);
    CHECK((at_point.look_at - at_point.position).norm() > 0.0);
}

TEST_CASE("a camera refuses what it cannot do", "[io][camera]")
{
    const Aabb box{{0, 0, 0}, {1, 1, 1}};
    CHECK_THROWS_AS(default_camera(box, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(default_camera(box, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
    CHECK_THROWS_AS(default_camera(box, 1.0, 4), std::invalid_argument);
    CHECK_THROWS_AS(fitted_camera(box, 1.0, Vec3d::Zero()), std::invalid_argument);
    CHECK_THROWS_AS(fitted_camera(box, 1.0, Vec3d::UnitX(), 171.0), std::invalid_argument);
}
