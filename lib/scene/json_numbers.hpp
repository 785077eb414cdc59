#pragma once

#include "flotsam/core/types.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>

namespace flotsam::scene {

using Json = nlohmann::ordered_json;

/// JSON has no NaN: null.
inline Json number(double value)
{
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
inline Json number(const std::optional<double>& value)
{
    return value ? number(*value) : Json(nullptr);
}
inline Json vector(const Vec3d& v)
{
    return Json::array({number(v.x()), number(v.y()), number(v.z())});
}

} // namespace flotsam::scene
