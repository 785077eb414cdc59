#pragma once

#include "geometry/attitude_descent.hpp"

#include <vector>

namespace flotsam {

/// A pose at rest and how many directions are flat there.
struct Minimum {
    Attitude attitude;
    int neutral_directions = 0;
};

/// The lowest of each family of neutral minima, and all others, with their neutral directions; `minima` come the lowest
/// first.
[[nodiscard]] std::vector<Minimum> lowest_of_families(const FlotationSolver& solver, std::vector<Minimum> minima);

} // namespace flotsam
