#pragma once

#include "geometry/flotation_solver.hpp"

#include <vector>

namespace flotsam {

/// Angles [rad] and energies over size: what equilibrium_poses.hpp promises.
inline constexpr double kSameAngle = 0.0035;   ///< 0.2 degrees
inline constexpr double kNeutralTurn = 0.1745; ///< 10 degrees
inline constexpr double kNeutralRise = 1e-5;
inline constexpr double kAtRest = 1e-9; ///< residual below which an attitude is one of equilibrium

/// The attitude after a turn [rad] about world x and y.
[[nodiscard]] Attitude turned(const FlotationSolver& solver, const Attitude& attitude, const Eigen::Vector2d& turn);

/// Between their vertical directions, seen from the body [rad].
[[nodiscard]] double angle_between(const Attitude& a, const Attitude& b);

/// Torque left, over m g size.
[[nodiscard]] double residual(const FlotationSolver& solver, const Attitude& attitude);

/// Downhill to a minimum of the energy; what it returns is at rest unless its residual says otherwise.
[[nodiscard]] Attitude descended(const FlotationSolver& solver, Attitude attitude);

/// Places on the floor of the valley that leads from a minimum about `axis` (of length one, in the minimum's world), a
/// degree apart: `strides` of them, fewer if it rises or falls by kNeutralRise or comes back to the minimum.
[[nodiscard]] std::vector<Attitude> level_valley(const FlotationSolver& solver, const Attitude& minimum,
                                                 Eigen::Vector2d axis, int strides);

/// In how many of the two principal directions a minimum is flat.
[[nodiscard]] int neutral_directions(const FlotationSolver& solver, const Attitude& minimum);

/// Whether the energy stays between `low` and `high` [m] on the way from one to the other, beside the shortest turn
/// where it is lower there.
[[nodiscard]] bool is_level_between(const FlotationSolver& solver, const Attitude& from, const Attitude& to, double low,
                                    double high);

} // namespace flotsam
