#include "flotsam/geometry/flotation.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "geometry/flotation_solver.hpp"
#include "geometry/principal_axes.hpp"
#include "geometry/wetted_surface.hpp"

#include <cmath>
#include <numbers>

namespace flotsam {
namespace {

void require_positive(double value, const char* allowed)
{
    require(value > 0.0 && std::isfinite(value), allowed, value);
}

Quatd unit(const Quatd& orientation)
{
    const double norm = orientation.norm();
    require(norm > 0.0 && std::isfinite(norm), "the norm of an orientation's quaternion must be > 0 and finite", norm);
    return orientation.normalized();
}

TriangleMesh about_center_of_mass(const FloatingBody& body)
{
    require_positive(body.mass, "mass must be > 0 kg and finite");
    require_positive(body.water_density, "water_density must be > 0 kg/m^3 and finite");
    require_positive(body.gravity, "gravity must be > 0 m/s^2 and finite");
    require(body.center_of_mass.allFinite(), "center_of_mass must be finite");
    require(!body.mesh.empty(), "a floating body must have triangles");
    return transformed(body.mesh, Pose{-body.center_of_mass, Quatd::Identity()});
}

/// d^2E / (m g) as flotation.hpp has it.
Eigen::Matrix2d curvature_of(const Waterplane& plane, double volume, double above_buoyancy)
{
    const Eigen::Matrix2d& I = plane.second_moment;
    Eigen::Matrix2d turned;
    turned << I(1, 1), -I(0, 1), -I(0, 1), I(0, 0);
    return turned / volume - above_buoyancy * Eigen::Matrix2d::Identity();
}

MetacentricHeights metacentric_heights(const Eigen::Matrix2d& curvature)
{
    const auto [values, axes] = principal_axes(curvature);
    const double angle = std::atan2(axes[0].y(), axes[0].x());
    const double wrapped = angle < 0.0 ? angle + std::numbers::pi : angle;
    return {curvature(0, 0), curvature(1, 1), values[0], values[1], wrapped < std::numbers::pi ? wrapped : 0.0};
}

} // namespace

FlotationSolver::FlotationSolver(const FloatingBody& body)
    : mesh_(about_center_of_mass(body)), center_of_mass_(body.center_of_mass),
      displaced_(body.mass / body.water_density), weight_(body.mass * body.gravity),
      whole_(mass_properties(mesh_).volume)
{
    require_positive(whole_, "the volume of a floating body must be > 0 m^3 and finite (closed mesh, normals outward)");
}

Attitude FlotationSolver::at(const Quatd& orientation) const
{
    const Quatd turned = unit(orientation);
    const HeightRange range = height_range(mesh_, {Vec3d::Zero(), turned});
    return at(turned, range.low + (range.high - range.low) * displaced_ / whole_);
}

Attitude FlotationSolver::at(const Quatd& orientation, double level_guess) const
{
    FLOTSAM_ASSERT(!sinks(), "what sinks has no attitude afloat");
    const Pose pose{Vec3d::Zero(), orientation};
    const HeightRange range = height_range(mesh_, pose);
    const double level =
        displaced_ < whole_ ? level_of_volume(mesh_, pose, displaced_, range, level_guess) : range.high;
    return attitude_in_water(mesh_, pose, level);
}

std::vector<char> FlotationSolver::hollows(const Quatd& orientation) const
{
    const WettedSurface surface(mesh_, {Vec3d::Zero(), unit(orientation)});
    const auto level = surface.level_of_basins(surface.low());
    return level ? surface.basins(*level) : std::vector<char>(mesh_.triangles.size(), 0);
}

std::optional<Attitude> FlotationSolver::dry_at(const Quatd& orientation, std::span<const char> hollows) const
{
    const Pose pose{Vec3d::Zero(), unit(orientation)};
    const WettedSurface surface(mesh_, pose);
    const auto found = surface.level_of_displacement(surface.low(), displaced_);
    if (!found) return std::nullopt;
    const double level = *found;
    const std::vector<char> is_dry = surface.basins(level);
    TriangleMesh wetted;
    wetted.vertices = mesh_.vertices;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
        if (is_dry[t] != 0) continue;
        const auto is_below = [&](int corner) { return pose.to_world(mesh_.corner(t, corner)).z() < level; };
        if (!hollows.empty() && hollows[t] != 0 && (is_below(0) || is_below(1) || is_below(2))) return std::nullopt;
        wetted.triangles.push_back(mesh_.triangles[t]);
    }
    return attitude_in_water(wetted, pose, level);
}

Attitude FlotationSolver::attitude_in_water(const TriangleMesh& wetted, const Pose& pose, double level) const
{
    Attitude attitude;
    attitude.orientation = pose.orientation;
    attitude.level = level;
    const SubmergedMoments sum = submerged_moments(wetted, pose, level);
    attitude.plane = waterplane_of(sum, pose);
    // The volume asked for, not the one reached: it is known to the last digit.
    const Vec3d center = Vec3d(0.0, 0.0, attitude.level) + sum.moment / displaced_;
    attitude.submerged = {displaced_, center, attitude.plane.area};
    attitude.energy = -center.z();
    attitude.slope = {-center.y(), center.x()};
    attitude.curvature = curvature_of(attitude.plane, displaced_, attitude.energy);
    return attitude;
}

Flotation FlotationSolver::flotation(const Attitude& attitude) const
{
    const Vec3d lift(0.0, 0.0, -attitude.level);
    Flotation result;
    result.pose = {lift - attitude.orientation * center_of_mass_, attitude.orientation};
    result.draft = attitude.level - height_range(mesh_, {Vec3d::Zero(), attitude.orientation}).low;
    result.submerged = attitude.submerged;
    result.submerged.center_of_buoyancy += lift;
    result.plane = attitude.plane;
    result.center_of_mass = lift;
    result.metacentric_heights = metacentric_heights(attitude.curvature);
    result.righting_arms = attitude.slope;
    result.energy = weight_ * attitude.energy;
    return result;
}

Quatd turned_by_heel(double heel, const Quatd& upright)
{
    return Quatd(Eigen::AngleAxisd(heel, Vec3d::UnitX())) * unit(upright);
}

RightingArm righting_arm(const FlotationSolver& solver, const Attitude& attitude, double heel)
{
    const Flotation afloat = solver.flotation(attitude);
    const double arm = afloat.righting_arms.x();
    return {heel, arm, solver.weight() * arm, afloat.draft, afloat.energy};
}

std::optional<Flotation> flotation(const FloatingBody& body, const Quatd& orientation)
{
    const FlotationSolver solver(body);
    if (solver.sinks()) return std::nullopt;
    return solver.flotation(solver.at(orientation));
}

std::vector<RightingArm> righting_arms(const FloatingBody& body, const Quatd& upright,
                                       std::span<const double> heel_angles)
{
    const FlotationSolver solver(body);
    require(!solver.sinks(),
            "a body with righting arms must float, and this one is heavier than the water it displaces");
    std::vector<RightingArm> arms;
    arms.reserve(heel_angles.size());
    for (const double heel : heel_angles) {
        require(std::isfinite(heel), "heel angles must be finite [rad]", heel);
        arms.push_back(righting_arm(solver, solver.at(turned_by_heel(heel, upright)), heel));
    }
    return arms;
}

} // namespace flotsam
