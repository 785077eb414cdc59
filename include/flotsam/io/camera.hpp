#pragma once

#include "flotsam/core/types.hpp"

namespace flotsam {

struct Camera {
    Vec3d position = Vec3d(0.0, -5.0, 0.0); ///< [m]
    Vec3d look_at = Vec3d::Zero();          ///< [m], elsewhere than position
    Vec3d up = Vec3d::UnitZ();              ///< not along the view
    double field_of_view_deg = 30.0;        ///< vertical, in (0, 170]
};

/// The camera closest to `contents` that has all of it in the picture, with a margin, looking along `direction`.
/// `aspect` = width / height, > 0. Throws std::invalid_argument; an empty box counts as a metre around the origin.
[[nodiscard]] Camera fitted_camera(const Aabb& contents, double aspect, const Vec3d& direction,
                                   double field_of_view_deg = 30.0);

/// Three-quarter view from above; with `dimensions` = 2 straight at the plane y = 0 through a long lens.
[[nodiscard]] Camera default_camera(const Aabb& contents, double aspect, int dimensions = 3);

} // namespace flotsam
