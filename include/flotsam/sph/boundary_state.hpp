#pragma once

#include "flotsam/core/types.hpp"

#include <cstdint>
#include <vector>

namespace flotsam {

/// Boundary samples of walls and bodies, plain arrays of equal length. Owner 0 is all walls, owner 1 + k body k.
struct BoundaryState {
    std::vector<Vec4> position;       ///< x, y, z [m]; w = rest volume V_b [m^3]
    std::vector<Vec4> velocity;       ///< x, y, z [m/s]; w = 0
    std::vector<std::int32_t> owner;  ///< 0: walls, 1 + k: body k
    std::vector<Vec3d> position_body; ///< in the owner's frame [m]

    [[nodiscard]] std::size_t size() const { return position.size(); }
};

} // namespace flotsam
