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
struct PixelPattern {
    float first, second;
    float cosine, sine; ///< of `second` as a part of a turn
};

[[nodiscard]] inline PixelPattern pixel_pattern(int column, int row)
{
    const auto x = static_cast<float>(column);
    const auto y = static_cast<float>(row);
    const float second = fraction(0.75487767f * x + 0.56984029f * y);
    const float angle = 2.0f * std::numbers::pi_v<float> * second;
    return {fraction(52.9829189f * fraction(0.06711056f * x + 0.00583715f * y)), second, std::cos(angle),
            std::sin(angle)};
}

/// A point of the unit disc.
struct DiscPoint {
    float x, y;
};

/// Evenly spread points of the unit disc for one sample of one pixel, the same in every run. All samples of a pixel
/// share one Hammersley set, shifted as a whole by the pixel's pattern.
class SampleSet {
  public:
    static constexpr unsigned kPoints = 2; ///< per sample

    SampleSet() = default;
    SampleSet(const PixelPattern& pattern, unsigned sample) : first_(sample * kPoints), pattern_(pattern) {}

    /// Point k < kPoints.
    [[nodiscard]] DiscPoint point(unsigned k) const
    {
        const unsigned n = first_ + k;
        constexpr float kAll = kPoints * kSamplesPerPixel;
        const float r = std::sqrt(fraction((static_cast<float>(n) + 0.5f) / kAll + pattern_.first));
        const auto [cosine, sine] = kTurns[n];
        return {r * (cosine * pattern_.cosine - sine * pattern_.sine),
                r * (sine * pattern_.cosine + cosine * pattern_.sine)};
    }

  private:
    static constexpr float kDiagonal = 0.5f * std::numbers::sqrt2_v<float>;
    /// Cosine and sine of eighths of a turn; which, says the number n < 8 with its binary digits mirrored.
    static constexpr float kTurns[kPoints * kSamplesPerPixel][2] = {{1.0f, 0.0f},
                                                                    {-1.0f, 0.0f},
                                                                    {0.0f, 1.0f},
                                                                    {0.0f, -1.0f},
                                                                    {kDiagonal, kDiagonal},
                                                                    {-kDiagonal, -kDiagonal},
                                                                    {-kDiagonal, kDiagonal},
                                                                    {kDiagonal, -kDiagonal}};

    unsigned first_ = 0;
    PixelPattern pattern_{};
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
[[nodiscard]] inline Vec3 direction_around(const Vec3& axis, DiscPoint point, float sine = 1.0f)
{
    const auto [t, s] = tangents(axis);
    const float x = sine * point.x;
    const float y = sine * point.y;
    return x * t + y * s + std::sqrt(std::max(0.0f, 1.0f - x * x - y * y)) * axis;
}

} // namespace flotsam
