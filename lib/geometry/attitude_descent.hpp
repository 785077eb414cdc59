#pragma once

#include "geometry/flotation_solver.hpp"

namespace flotsam {

/// Angles [rad] and energies over size: what equilibrium_poses.hpp promises.
inline constexpr double kSameAngle = 0.0035;   ///< 0.2 degrees
inline constexpr double kNeutralTurn = 0.1745; ///< 10 degrees
inline constexpr double kNeutralRise = 1e-5;
inline constexpr double kAtRest = 1e-9; ///< residual below which an attitude is one of equilibrium

/// The attitude after a turn [rad] about world x and y.
[[nodiscard]] Attitude turned(const FlotationSolver& solver, const Attitude& attitude, const Eigen::Vector2d& turn);

/// Torque left, over m g size.
[[nodiscard]] double residual(const FlotationSolver& solver, const Attitude& attitude);

/// Downhill to a minimum of the energy; what it returns is at rest unless its residual says otherwise.
[[nodiscard]] Attitude descended(const FlotationSolver& solver, Attitude attitude);

/// In how many of the two principal directions a minimum is flat.
[[nodiscard]] int neutral_directions(const FlotationSolver& solver, const Attitude& minimum);

/// Whether the shortest turn from one to the other climbs no higher than kNeutralRise above the higher one.
[[nodiscard]] bool is_level_between(const FlotationSolver& solver, const Attitude& from, const Attitude& to);

} // namespace flotsam
