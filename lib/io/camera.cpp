#include "flotsam/io/camera.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace flotsam {

namespace {

constexpr double kMargin = 1.06; ///< of the picture's half size over the contents'

/// Where along one picture axis, and how far back, a camera must stand so that points (`offset` on the axis, `depth`
/// along the view) lie between two planes that open with the slope `tangent`.
struct AxisFit {
    double offset, depth;
};

AxisFit fit(const std::array<double, 8>& offset, const std::array<double, 8>& depth, double tangent)
{
    double right = -1e300;
    double left = -1e300;
    for (std::size_t k = 0; k < 8; ++k) {
        right = std::max(right, offset[k] - tangent * depth[k]);
        left = std::max(left, -offset[k] - tangent * depth[k]);
    }
    return {0.5 * (right - left), -0.5 * (right + left) / tangent};
}

Vec3d corner(const Aabb& box, std::size_t k)
{
    return {(k & 1) ? box.max.x() : box.min.x(), (k & 2) ? box.max.y() : box.min.y(),
            (k & 4) ? box.max.z() : box.min.z()};
}

} // namespace

Camera fitted_camera(const Aabb& contents, double aspect, const Vec3d& direction, double field_of_view_deg)
{
    require(aspect > 0.0 && std::isfinite(aspect), "the aspect of a picture (width / height) must be > 0", aspect);
    require(direction.norm() > 0.0 && direction.allFinite(), "a view must have a direction");
    require(field_of_view_deg > 0.0 && field_of_view_deg <= 170.0,
            "the field of view must be above 0 and at most 170 degrees", field_of_view_deg);
    const Aabb box = contents.empty() ? Aabb{Vec3d::Constant(-0.5), Vec3d::Constant(0.5)} : contents;
    const Vec3d forward = direction.normalized();
    const bool vertical = std::abs(forward.z()) > 0.999;
    const Vec3d right = forward.cross(vertical ? Vec3d::UnitY() : Vec3d::UnitZ()).normalized();
    const Vec3d up = right.cross(forward);

    std::array<double, 8> x{};
    std::array<double, 8> y{};
    std::array<double, 8> depth{};
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3d arm = corner(box, k) - box.center();
        x[k] = arm.dot(right);
        y[k] = arm.dot(up);
        depth[k] = arm.dot(forward);
    }
    const double tangent = std::tan(0.5 * field_of_view_deg * std::numbers::pi / 180.0) / kMargin;
    const AxisFit horizontal_fit = fit(x, depth, tangent * aspect);
    const AxisFit vertical_fit = fit(y, depth, tangent);
    const double back = std::min({horizontal_fit.depth, vertical_fit.depth, -1e-3});
    Camera camera;
    camera.position = box.center() + horizontal_fit.offset * right + vertical_fit.offset * up + back * forward;
    camera.look_at = camera.position - back * forward;
    camera.up = up;
    camera.field_of_view_deg = field_of_view_deg;
    return camera;
}

Camera default_camera(const Aabb& contents, double aspect, int dimensions)
{
    require(dimensions == 2 || dimensions == 3, "dimensions must be 2 or 3", dimensions);
    if (dimensions == 2) return fitted_camera(contents, aspect, Vec3d::UnitY(), 4.0);
    return fitted_camera(contents, aspect, Vec3d(0.55, 1.0, -0.45));
}

} // namespace flotsam
