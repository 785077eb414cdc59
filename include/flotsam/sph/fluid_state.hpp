#pragma once

#include "flotsam/core/types.hpp"

#include <cstdint>
#include <vector>

namespace flotsam {

/// The owned fluid particles, plain arrays of equal length, in memory order (cells of the neighbour grid).
struct FluidState {
    std::vector<Vec4> position;    ///< x, y, z [m]; w unused (0)
    std::vector<Vec4> velocity;    ///< x, y, z [m/s]; w = 0
    std::vector<Scalar> density;   ///< [kg/m^3] ([kg/m^2] in 2-D: per metre of width the same number)
    std::vector<Scalar> pressure;  ///< [Pa], of the last step
    std::vector<std::uint32_t> id; ///< order of creation: names a particle for good
    double particle_mass = 0.0;    ///< rho0 d^dimensions [kg]

    [[nodiscard]] std::size_t size() const { return position.size(); }
};

} // namespace flotsam
