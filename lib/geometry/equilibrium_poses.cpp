#include "flotsam/geometry/equilibrium_poses.hpp"

#include "geometry/attitude_descent.hpp"
#include "geometry/pose_families.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace flotsam {
namespace {

constexpr int kStarts = 162;
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// The k-th of `count` directions that are spread evenly and lie on no axis.
Vec3d start_direction(int k, int count)
{
    const double z = 1.0 - (2.0 * k + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    const double phi = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    return {r * std::cos(phi), r * std::sin(phi), z};
}

struct HeelAndTrim {
    double heel; ///< [rad]
    double trim; ///< [rad]
};

HeelAndTrim heel_and_trim(const Vec3d& up_body)
{
    const double across = std::hypot(up_body.y(), up_body.z());
    return {across > 1e-12 ? std::atan2(up_body.y(), up_body.z()) : 0.0, std::atan2(-up_body.x(), across)};
}

/// The orientation without yaw in which `up_body` is up.
Quatd upright_orientation(const Vec3d& up_body)
{
    const auto [heel, trim] = heel_and_trim(up_body);
    return Quatd(Eigen::AngleAxisd(trim, Vec3d::UnitY()) * Eigen::AngleAxisd(heel, Vec3d::UnitX()));
}

EquilibriumPose pose_of(const FlotationSolver& solver, const Minimum& minimum)
{
    const Attitude& attitude = minimum.attitude;
    const auto [heel, trim] = heel_and_trim(attitude.up_body());
    const Eigen::AngleAxisd rotation(attitude.orientation);
    EquilibriumPose pose;
    pose.flotation = solver.flotation(attitude);
    pose.heel_deg = heel > -std::numbers::pi + 1e-6 ? heel * kDegrees : 180.0; // upside down has one name
    pose.trim_deg = trim * kDegrees;
    pose.rotation_deg = rotation.angle() * kDegrees * rotation.axis();
    pose.neutral_directions = minimum.neutral_directions;
    pose.residual = residual(solver, attitude);
    return pose;
}

/// What the starts come to, each place once, the lowest first.
std::vector<Minimum> distinct(std::vector<Attitude> ends)
{
    std::stable_sort(ends.begin(), ends.end(),
                     [](const Attitude& a, const Attitude& b) { return a.energy < b.energy; });
    std::vector<Minimum> kept;
    for (const Attitude& end : ends) {
        const auto is_same = [&](const Minimum& other) { return angle_between(other.attitude, end) < kSameAngle; };
        if (std::none_of(kept.begin(), kept.end(), is_same)) kept.push_back({end});
    }
    return kept;
}

/// Poses of one energy, whose order is that of rounding: the nearest to the body as it is modelled first.
void order_equals(std::vector<EquilibriumPose>& poses, double same_energy)
{
    const auto key = [](const EquilibriumPose& pose) {
        const auto whole = [](double deg) { return std::lround(100.0 * deg); };
        return std::array{whole(std::abs(pose.trim_deg)), whole(std::abs(pose.heel_deg)), -whole(pose.heel_deg),
                          -whole(pose.trim_deg)};
    };
    for (auto first = poses.begin(); first != poses.end();) {
        const auto last = std::find_if(first, poses.end(), [&](const EquilibriumPose& pose) {
            return pose.flotation.energy > first->flotation.energy + same_energy;
        });
        std::stable_sort(first, last, [&](const auto& p, const auto& q) { return key(p) < key(q); });
        first = last;
    }
}

} // namespace

NoEquilibrium::NoEquilibrium(double smallest_residual)
    : std::runtime_error([&] {
          std::ostringstream sentence;
          sentence << "no equilibrium was found: the smallest torque left is " << smallest_residual
                   << " m g times the cube root of the volume, and must be at most " << kAtRest;
          return sentence.str();
      }()),
      residual(smallest_residual)
{
}

std::optional<EquilibriumPoses> stable_poses(const FloatingBody& body)
{
    const FlotationSolver solver(body);
    if (solver.sinks()) return std::nullopt;
    EquilibriumPoses found;
    found.starts = kStarts;
    std::vector<Attitude> ends;
    double smallest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kStarts; ++k) {
        Attitude end = descended(solver, solver.at(upright_orientation(start_direction(k, kStarts))));
        smallest = std::min(smallest, residual(solver, end));
        if (residual(solver, end) <= kAtRest)
            ends.push_back(solver.at(upright_orientation(end.up_body()), end.level)); // its way may have yawed it
        else
            ++found.unconverged_starts;
    }
    if (ends.empty()) throw NoEquilibrium(smallest);
    for (const Minimum& minimum : lowest_of_families(solver, distinct(std::move(ends))))
        found.poses.push_back(pose_of(solver, minimum));
    order_equals(found.poses, 1e-9 * solver.weight() * solver.size());
    return found;
}

std::optional<EquilibriumPose> settled_pose(const FloatingBody& body, const Quatd& start)
{
    const FlotationSolver solver(body);
    if (solver.sinks()) return std::nullopt;
    const Attitude end = descended(solver, solver.at(start));
    if (!(residual(solver, end) <= kAtRest)) throw NoEquilibrium(residual(solver, end));
    return pose_of(solver, {end, neutral_directions(solver, end)});
}

} // namespace flotsam
