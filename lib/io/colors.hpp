#pragma once

#include "flotsam/core/types.hpp"

#include <cstdint>

namespace flotsam {

/// Light adds up linearly; colours are given and stored as sRGB. **Source:** IEC 61966-2-1.
[[nodiscard]] Vec3 linear_from_srgb(const Vec3& srgb);

/// Rolls bright light off towards white, then encodes as sRGB bytes, rounded at `dither` (0 to 1, differing from pixel
/// to pixel, so that slow gradients show no bands).
void store_srgb(const Vec3& linear, float dither, std::uint8_t* rgb);

} // namespace flotsam
