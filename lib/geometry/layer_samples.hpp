#pragma once

#include "geometry/offset_surface.hpp"

#include "flotsam/core/parallel.hpp"

#include <array>
#include <vector>

namespace flotsam {

/// A part of a surface. By default all of it.
struct LayerPart {
    Aabb region = {Vec3d::Constant(-1e300), Vec3d::Constant(1e300)}; ///< samples are chosen in it
    Aabb moves = region;                                             ///< and move to be even, within this
    std::array<bool, 6> is_continued{}; ///< by fixed samples beyond the region's side -x +x -y +y -z +z
};

/// An even layer of samples on the offset surface, the first of them `fixed`, which stay where they are. Within about
/// two spacings of the region's border the layer is less even.
[[nodiscard]] std::vector<OffsetPoint> sample_layer(const OffsetSurface& offset, const SurfaceSampleSettings& settings,
                                                    std::vector<OffsetPoint> fixed, const LayerPart& part,
                                                    const Workers& workers);

} // namespace flotsam
