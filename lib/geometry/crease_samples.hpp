#pragma once

#include "geometry/offset_surface.hpp"

#include <vector>

namespace flotsam {

/// Samples along the lines that an even layer must not miss: sharp edges of the offset surface, with a sample in each
/// of their corners, and the rims at which open sheets end.
[[nodiscard]] std::vector<OffsetPoint> sample_creases(const OffsetSurface& offset, double spacing);

} // namespace flotsam
