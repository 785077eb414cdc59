#pragma once

namespace flotsam {

/// Length of the next step when `left` seconds are left and `allowed` is the longest: the last one ends exactly, and
/// what is left is halved where a full step would leave a sliver.
[[nodiscard]] inline double next_step(double left, double allowed)
{
    if (left <= allowed) return left;
    return left < 2.0 * allowed ? 0.5 * left : allowed;
}

} // namespace flotsam
