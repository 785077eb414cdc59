#pragma once

#include "flotsam/core/types.hpp"

#include <cstdint>
#include <vector>

namespace flotsam {

/// Boundary samples of walls and bodies, plain arrays of equal length. Owners are numbered walls first,
/// then bodies.
struct BoundaryState {
    std::vector<Vec4> position;       ///< x, y, z [m]; w = rest volume V_b [m^3]
    std::vector<Vec4> velocity;       ///< x, y, z [m/s]; w = 0
    std::vector<std::int32_t> owner;  ///< walls first, then bodies
    std::vector<Vec3d> position_body; ///< in the owner's frame [m]

    [[nodiscard]] std::size_t size() const { return position.size(); }
};

} // namespace flotsam
