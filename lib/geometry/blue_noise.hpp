#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Indices of `count` of the points, ascending, chosen so that they keep apart as evenly as can be: the most crowded
/// go first, but none of the first `fixed`. `reach` is the distance up to which points crowd each other: twice the
/// radius of discs that fill the surface. **Source:** Yuksel 2015, weighted sample elimination.
[[nodiscard]] std::vector<std::size_t> eliminate_crowded(std::span<const Vec3d> points, std::size_t fixed,
                                                         std::size_t count, double reach, const Workers& workers);

} // namespace flotsam
