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
constexpr int kNeutralStrides = 10;
constexpr double kStride = kNeutralTurn / kNeutralStrides; ///< along a valley [rad]
constexpr double kValley = 10.0;                           ///< a valley is so many times as stiff across as along

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

/// A quarter turn from `axis`, about the vertical.
Vector2d across(const Vector2d& axis)
{
    return {-axis.y(), axis.x()};
}

/// The lowest place on the way across the valley that leads about `axis` (of length one), and how far that is [rad].
struct Floor {
    Attitude attitude;
    double across = 0.0;
};

Floor floor_below(const FlotationSolver& solver, const Attitude& start, const Vector2d& axis)
{
    const Vector2d aside = across(axis);
    Floor floor{start};
    for (int step = 0; step < 8; ++step) {
        const double slope = floor.attitude.slope.dot(aside);
        const double stiffness = std::max(std::abs(aside.dot(floor.attitude.curvature * aside)), 1e-9 * solver.size());
        if (0.5 * slope * slope / stiffness < 0.01 * kNeutralRise * solver.size()) break; // it would win no more
        const double way = std::clamp(-slope / stiffness, -kStride, kStride);
        Attitude next = turned(solver, floor.attitude, way * aside);
        if (next.energy >= floor.attitude.energy) break;
        floor = {std::move(next), floor.across + way};
    }
    return floor;
}

/// Whether a straight turn by kNeutralTurn about `axis` stays below kNeutralRise.
bool is_level_turn(const FlotationSolver& solver, const Attitude& minimum, const Vector2d& axis)
{
    for (int k = 1; k <= kNeutralStrides; ++k) {
        const double energy = turned(solver, minimum, k * kStride * axis).energy;
        if (!(energy < minimum.energy + kNeutralRise * solver.size())) return false;
    }
    return true;
}

} // namespace

Attitude turned(const FlotationSolver& solver, const Attitude& attitude, const Vector2d& turn)
{
    const Twist twist{Vec3d::Zero(), Vec3d(turn.x(), turn.y(), 0.0)};
    return solver.at(moved({Vec3d::Zero(), attitude.orientation}, twist, 1.0).orientation, attitude.level);
}

double angle_between(const Attitude& a, const Attitude& b)
{
    const Vec3d u = a.up_body(), v = b.up_body();
    return std::atan2(u.cross(v).norm(), u.dot(v));
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

std::vector<Attitude> level_valley(const FlotationSolver& solver, const Attitude& minimum, Vector2d axis, int strides)
{
    std::vector<Attitude> places;
    Attitude attitude = minimum;
    for (int k = 1; k <= strides; ++k) {
        const Floor floor = floor_below(solver, turned(solver, attitude, kStride * axis), axis);
        if (!(std::abs(floor.attitude.energy - minimum.energy) < kNeutralRise * solver.size())) break;
        attitude = floor.attitude;
        axis = (kStride * axis + floor.across * across(axis)).normalized();
        places.push_back(attitude);
        if (k > kNeutralStrides && angle_between(attitude, minimum) < kStride) break;
    }
    return places;
}

int neutral_directions(const FlotationSolver& solver, const Attitude& minimum)
{
    const auto [stiffness, axes] = principal_axes(minimum.curvature);
    const auto is_level = [&](const Vector2d& axis) { return is_level_turn(solver, minimum, axis); };
    const auto has_valley = [&](const Vector2d& axis) {
        return level_valley(solver, minimum, axis, kNeutralStrides).size() == kNeutralStrides;
    };
    int flat = 0;
    for (const Vector2d& axis : axes) flat += is_level(axis) && is_level(-axis) ? 1 : 0;
    if (flat > 0 || stiffness[1] < kValley * std::abs(stiffness[0])) return flat;
    return has_valley(axes[0]) && has_valley(-axes[0]) ? 1 : 0;
}

bool is_level_between(const FlotationSolver& solver, const Attitude& from, const Attitude& to, double low, double high)
{
    // The turn that makes `to`'s up vertical, in the world of `from`; about x where that is the one below.
    const Vec3d up = from.orientation * to.up_body();
    const Vector2d axis(up.y(), -up.x());
    const double sine = axis.norm(), angle = std::atan2(sine, up.z());
    const int strides = std::max(2, static_cast<int>(std::ceil(angle / (2.0 * kStride))));
    const Vector2d way = sine > 0.0 ? Vector2d(axis / sine) : Vector2d::UnitX();
    Attitude attitude = from;
    double beside = 0.0;
    for (int k = 1; k <= strides; ++k) {
        attitude = turned(solver, attitude, angle / strides * way);
        const Floor floor = k < strides ? floor_below(solver, attitude, way) : Floor{attitude};
        const bool leaps = std::abs(floor.across - beside) > 4.0 * kStride; // over a ridge, perhaps
        const double energy = floor.attitude.energy;
        if (!(energy >= low && energy <= high) || leaps) return false;
        beside = floor.across;
    }
    return true;
}

} // namespace flotsam
