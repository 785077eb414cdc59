#pragma once

#include "geometry/offset_surface.hpp"

#include <vector>

namespace flotsam {

/// sample_surface in two dimensions: the outline is the mesh's cut with the plane y = 0. One set of samples, or of a
/// sheet one for each side.
[[nodiscard]] std::vector<std::vector<OffsetPoint>> sample_outline(const SurfaceQuery& surface,
                                                                   const SurfaceSampleSettings& settings);

} // namespace flotsam
