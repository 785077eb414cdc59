#pragma once

#include <algorithm>

namespace flotsam {

/// From 0 at x <= 0 to 1 at x >= 1 without a kink: 3 x^2 - 2 x^3.
[[nodiscard]] inline double smooth_step(double x)
{
    const double t = std::clamp(x, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

} // namespace flotsam
