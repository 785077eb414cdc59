#pragma once

namespace flotsam {

/// Length of the next step when `left` seconds are left and `allowed` is the longest: the last one ends exactly, and
/// what is left is halved where a full step would leave a sliver. A step that Bullet's single precision has rounded up
/// past `allowed` is one step all the same.
[[nodiscard]] inline double next_step(double left, double allowed)
{
    constexpr double kRounding = 1e-6; // relative; of single precision 6e-8
    if (left <= (1.0 + kRounding) * allowed) return left;
    return left < 2.0 * allowed ? 0.5 * left : allowed;
}

} // namespace flotsam
