#pragma once

#include "flotsam/core/types.hpp"
#include "flotsam/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flotsam {

using OpenSides = std::array<bool, 6>; ///< -x +x -y +y -z +z

/// Of a box wall, by their names.
[[nodiscard]] inline OpenSides open_sides(const std::vector<std::string>& names)
{
    const std::array<const char*, 6> sides{"-x", "+x", "-y", "+y", "-z", "+z"};
    OpenSides open{};
    for (std::size_t k = 0; k < sides.size(); ++k)
        open[k] = std::find(names.begin(), names.end(), sides[k]) != names.end();
    return open;
}

/// How far two boxes are apart along the axis along which closed sides of both part them [m]; nothing if none does.
/// Boxes that are parted are tanks of their own; what is within several others is in a room that they bound together.
[[nodiscard]] inline std::optional<double> parted_by(const Aabb& a, const OpenSides& a_open, const Aabb& b,
                                                     const OpenSides& b_open, int dimensions)
{
    std::optional<double> widest;
    for (int axis = 0; axis < 3; ++axis) {
        if (dimensions == 2 && axis == 1) continue;
        const std::size_t low = 2 * static_cast<std::size_t>(axis), high = low + 1;
        const auto consider = [&](double gap, bool is_open) {
            if (gap >= 0.0 && !is_open && gap >= widest.value_or(0.0)) widest = gap;
        };
        consider(b.min[axis] - a.max[axis], a_open[high] || b_open[low]);
        consider(a.min[axis] - b.max[axis], b_open[high] || a_open[low]);
    }
    return widest;
}

} // namespace flotsam
