#pragma once

#include "flotsam/core/types.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flotsam {

inline constexpr unsigned kSamplesPerPixel = 4;

/// Four places in a pixel, no two in a row or column (rotated grid).
[[nodiscard]] inline std::pair<float, float> place_in_pixel(unsigned sample)
{
    constexpr float kX[] = {0.375f, 0.875f, 0.125f, 0.625f};
    constexpr float kY[] = {0.125f, 0.375f, 0.625f, 0.875f};
    return {kX[sample], kY[sample]};
}

[[nodiscard]] inline float fraction(float x)
{
    return x - std::floor(x);
}

/// Two numbers in [0, 1) that differ most between near pixels, so that the eye takes the mean over them.
/// **Source:** Jimenez 2014, "Next generation post processing in Call of Duty" (interleaved gradient noise); Roberts
/// 2018, "The unreasonable effectiveness of quasirandom sequences" (R2).
[[nodiscard]] inline std::pair<float, float> pixel_pattern(int column, int row)
{
    const auto x = static_cast<float>(column);
    const auto y = static_cast<float>(row);
    return {fraction(52.9829189f * fraction(0.06711056f * x + 0.00583715f * y)),
            fraction(0.75487767f * x + 0.56984029f * y)};
}

/// Evenly spread points of [0, 1)^2 for one sample of one pixel, the same in every run. All samples of a pixel share
/// one Hammersley set, shifted as a whole by the pixel's pattern.
class SampleSet {
  public:
    static constexpr unsigned kPoints = 2; ///< per sample

    SampleSet(int column, int row, unsigned sample) : first_(sample * kPoints), shift_(pixel_pattern(column, row)) {}

    /// Point k < kPoints.
    [[nodiscard]] std::pair<float, float> point(unsigned k) const
    {
        const unsigned n = first_ + k;
        constexpr float kAll = kPoints * kSamplesPerPixel;
        return {fraction((static_cast<float>(n) + 0.5f) / kAll + shift_.first), fraction(reversed(n) + shift_.second)};
    }

  private:
    /// The binary digits of n < 8 mirrored at the point.
    static float reversed(unsigned n)
    {
        return 0.5f * static_cast<float>(n & 1u) + 0.25f * static_cast<float>((n >> 1u) & 1u) +
               0.125f * static_cast<float>((n >> 2u) & 1u);
    }
    unsigned first_;
    std::pair<float, float> shift_;
};

/// Two directions at right angles to `axis` and each other. **Source:** Duff et al. 2017, "Building an orthonormal
/// basis, revisited".
[[nodiscard]] inline std::pair<Vec3, Vec3> tangents(const Vec3& axis)
{
    const float sign = std::copysign(1.0f, axis.z());
    const float a = -1.0f / (sign + axis.z());
    const float b = axis.x() * axis.y() * a;
    return {Vec3(1.0f + sign * axis.x() * axis.x() * a, sign * b, -sign * axis.x()),
            Vec3(b, sign + axis.y() * axis.y() * a, -axis.y())};
}

/// A direction around `axis`: uniform over the disc of `sine` (1: cosine-weighted over the half space).
[[nodiscard]] inline Vec3 direction_around(const Vec3& axis, std::pair<float, float> point, float sine = 1.0f)
{
    const float r = sine * std::sqrt(point.first);
    const float angle = 2.0f * std::numbers::pi_v<float> * point.second;
    const auto [t, s] = tangents(axis);
    return r * std::cos(angle) * t + r * std::sin(angle) * s + std::sqrt(std::max(0.0f, 1.0f - r * r)) * axis;
}

} // namespace flotsam
