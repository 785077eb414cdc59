#pragma once

#include "flotsam/core/types.hpp"

#include <cstdint>
#include <vector>

namespace flotsam {

/// Boundary samples of walls and bodies, plain arrays of equal length (those of sheets' normals may be empty). Owners
/// are numbered walls first, then bodies.
struct BoundaryState {
    std::vector<Vec4> position;       ///< x, y, z [m]; w = 0
    std::vector<Scalar> volume;       ///< rest volume V_b [m^3]
    std::vector<Vec4> velocity;       ///< x, y, z [m/s]; w = 0
    std::vector<std::int32_t> owner;  ///< walls first, then bodies
    std::vector<Vec3d> position_body; ///< in the owner's frame [m]
    /// Of samples of sheets x, y, z: unit, from the sample to the face whose water alone feels it (0: all water on its
    /// side does); w: its depth below that face [m]. 0 for all others. Empty as long as there is no sheet.
    std::vector<Vec4> normal;
    std::vector<Vec4> normal_body; ///< the same in the owner's frame; w: number of the side of the sheet

    [[nodiscard]] std::size_t size() const { return position.size(); }
};

} // namespace flotsam
