#include "geometry/attitude_descent.hpp"

#include "geometry/principal_axes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace flotsam {
namespace {

using Eigen::Vector2d;

constexpr int kMostSteps = 300;
constexpr double kLongestStep = 0.2; ///< [rad]
constexpr double kRounding = 1e-14;  ///< of an energy, over size

/// Newton's step with the curvature's eigenvalues made positive: downhill whatever they are.
Vector2d newton_step(const FlotationSolver& solver, const Attitude& attitude)
{
    const PrincipalAxes principal = principal_axes(attitude.curvature);
    Vector2d step = Vector2d::Zero();
    for (std::size_t k = 0; k < 2; ++k) {
        const Vector2d& axis = principal.axes[k];
        const double stiffness = std::max(std::abs(principal.values[k]), 1e-9 * solver.size());
        step -= axis * (axis.dot(attitude.slope) / stiffness);
    }
    const double length = step.norm();
    return length > kLongestStep ? Vector2d(step * (kLongestStep / length)) : step;
}

/// Halves the step until the energy falls by a part of what the slope promises; near the bottom, where that drowns in
/// rounding, until the slope falls.
std::optional<Attitude> lowered(const FlotationSolver& solver, const Attitude& attitude, Vector2d step)
{
    const double slack = kRounding * solver.size();
    for (int halving = 0; halving < 40; ++halving, step *= 0.5) {
        Attitude next = turned(solver, attitude, step);
        const double promised = attitude.slope.dot(step);
        const bool falls = next.energy < attitude.energy + 1e-4 * promised;
        const bool flattens = next.energy <= attitude.energy + slack && next.slope.norm() < 0.9 * attitude.slope.norm();
        if (falls || flattens) return next;
    }
    return std::nullopt;
}

/// Where it is lower beside an attitude at rest that is no minimum: a saddle, a top, or a flat that bends down.
std::optional<Attitude> lower_beside(const FlotationSolver& solver, const Attitude& attitude)
{
    const PrincipalAxes principal = principal_axes(attitude.curvature);
    if (principal.values[0] > 1e-6 * solver.size()) return std::nullopt;
    for (const double angle : {0.02, -0.02, 0.002, -0.002}) {
        Attitude beside = turned(solver, attitude, angle * principal.axes[0]);
        if (beside.energy < attitude.energy - 1e-12 * solver.size()) return beside;
    }
    return std::nullopt;
}

/// The energy on the floor of a valley that leads about `axis` (of length one), to second order: a family of poses that
/// goes around a body lies on no great circle.
double valley_energy(const Attitude& attitude, const Vector2d& axis)
{
    const Vector2d across(-axis.y(), axis.x());
    const double stiffness = across.dot(attitude.curvature * across);
    const bool is_valley = stiffness > 10.0 * std::abs(axis.dot(attitude.curvature * axis));
    const double slope = attitude.slope.dot(across);
    return is_valley ? attitude.energy - 0.5 * slope * slope / stiffness : attitude.energy;
}

} // namespace

Attitude turned(const FlotationSolver& solver, const Attitude& attitude, const Vector2d& turn)
{
    const Twist twist{Vec3d::Zero(), Vec3d(turn.x(), turn.y(), 0.0)};
    return solver.at(moved({Vec3d::Zero(), attitude.orientation}, twist, 1.0).orientation, attitude.level);
}

double residual(const FlotationSolver& solver, const Attitude& attitude)
{
    return attitude.slope.norm() / solver.size();
}

Attitude descended(const FlotationSolver& solver, Attitude attitude)
{
    for (int step = 0; step < kMostSteps; ++step) {
        const bool is_at_rest = residual(solver, attitude) <= kAtRest;
        std::optional<Attitude> next =
            is_at_rest ? lower_beside(solver, attitude) : lowered(solver, attitude, newton_step(solver, attitude));
        if (!next) break;
        attitude = std::move(*next);
    }
    return attitude;
}

int neutral_directions(const FlotationSolver& solver, const Attitude& minimum)
{
    int flat = 0;
    for (const Vector2d& axis : principal_axes(minimum.curvature).axes) {
        const double one_way = valley_energy(turned(solver, minimum, kNeutralTurn * axis), axis);
        const double other_way = valley_energy(turned(solver, minimum, -kNeutralTurn * axis), axis);
        const double highest = std::max(one_way, other_way);
        if (highest - minimum.energy < kNeutralRise * solver.size()) ++flat;
    }
    return flat;
}

bool is_level_between(const FlotationSolver& solver, const Attitude& from, const Attitude& to)
{
    constexpr double kStride = 0.035; // 2 degrees
    const double bound = std::max(from.energy, to.energy) + kNeutralRise * solver.size();
    // The turn that makes `to`'s up vertical, in the world of `from`; about x where that is the one below.
    const Vec3d up = from.orientation * to.up_body();
    const Vector2d axis(up.y(), -up.x());
    const double sine = axis.norm(), angle = std::atan2(sine, up.z());
    const int strides = static_cast<int>(std::ceil(angle / kStride));
    const Vector2d way = sine > 0.0 ? Vector2d(axis / sine) : Vector2d::UnitX();
    Attitude attitude = from;
    for (int k = 1; k < strides; ++k) {
        attitude = turned(solver, attitude, angle / strides * way);
        if (valley_energy(attitude, way) > bound) return false;
    }
    return true;
}

} // namespace flotsam
