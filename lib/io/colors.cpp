#include "io/colors.hpp"

#include "flotsam/io/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flotsam {

Vec3 speed_color(double fraction)
{
    // Lightness rises by nearly equal amounts from stop to stop.
    static const std::array<Vec3, 6> kStops = {Vec3(0.05f, 0.26f, 0.57f), Vec3(0.05f, 0.38f, 0.71f),
                                               Vec3(0.08f, 0.48f, 0.76f), Vec3(0.26f, 0.67f, 0.86f),
                                               Vec3(0.61f, 0.86f, 0.93f), Vec3(0.97f, 0.99f, 1.00f)};
    const double clamped = fraction > 0.0 ? std::min(fraction, 1.0) : 0.0;
    const double at = clamped * static_cast<double>(kStops.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
    const auto t = static_cast<Scalar>(at - static_cast<double>(k));
    return (1.0f - t) * kStops[k] + t * kStops[k + 1];
}

Vec3 body_color(std::size_t body)
{
    static const std::array<Vec3, 8> kPalette = {
        Vec3(0.89f, 0.34f, 0.18f), Vec3(0.96f, 0.73f, 0.20f), Vec3(0.45f, 0.66f, 0.28f), Vec3(0.64f, 0.25f, 0.47f),
        Vec3(0.93f, 0.89f, 0.80f), Vec3(0.55f, 0.36f, 0.24f), Vec3(0.95f, 0.56f, 0.58f), Vec3(0.28f, 0.28f, 0.32f)};
    return kPalette[body % kPalette.size()];
}

Vec3 linear_from_srgb(const Vec3& srgb)
{
    return srgb.unaryExpr([](Scalar c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); });
}

void store_srgb(const Vec3& linear, float dither, std::uint8_t* rgb)
{
    for (int k = 0; k < 3; ++k) {
        const float x = std::max(linear[k], 0.0f);
        constexpr float kKnee = 0.8f; // as it is below, rolled off above
        const float c = x <= kKnee ? x : kKnee + (1.0f - kKnee) * (1.0f - std::exp(-(x - kKnee) / (1.0f - kKnee)));
        const float encoded = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
        rgb[k] = static_cast<std::uint8_t>(std::clamp(255.0f * encoded + dither, 0.0f, 255.0f));
    }
}

} // namespace flotsam
