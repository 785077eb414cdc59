// Bodies held at a heel in the water: the moment that turns them back, against exact clipping of their meshes.
#include "validation/righting_arms.hpp"

#include "flotsam/geometry/flotation.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "validation/case.hpp"
#include "validation/take_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>

namespace flotsam::validation {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Righting arms at heels in degrees [m].
std::vector<double> exact_arms(const FloatingBody& body, std::span<const double> degrees)
{
    std::vector<double> turns(degrees.begin(), degrees.end()), arms;
    for (double& turn : turns) turn *= kDegree;
    for (const RightingArm& point : righting_arms(body, Quatd::Identity(), turns)) arms.push_back(point.arm);
    return arms;
}

// -- boxes ------------------------------------------------------------------------------------------------------------

/// A long box of half the water's density, whose arms are those of its section.
FloatingBody long_box(double width, double height)
{
    constexpr double kLength = 10.0;
    FloatingBody box;
    box.mesh = tessellate(BoxShape{Vec3d(kLength, width, height)}, kLength);
    box.mass = 0.5 * kWater * kLength * width * height;
    box.water_density = kWater;
    return box;
}

// -- a hull -----------------------------------------------------------------------------------------------------------

constexpr WigleyHull kHull{.length = 0.40, .breadth = 0.16, .draft = 0.08, .freeboard = 0.06};

/// Afloat at its water line, its centre of mass in the middle of the draft.
FloatingBody ballasted_hull()
{
    FloatingBody hull;
    hull.mesh = wigley_hull(kHull, 48, 16);
    hull.mass = kWater * submerged_part(hull.mesh, Pose{}, 0.0).volume;
    hull.center_of_mass = Vec3d(0.0, 0.0, -0.5 * kHull.draft);
    hull.water_density = kWater;
    hull.gravity = kGravity;
    return hull;
}

/// What the water does to the hull, mean over a quarter of a second: it has started at rest, and stays so.
struct Held {
    Wrench wrench;                ///< about the centre of mass
    double exact_buoyancy = 0.0;  ///< at the water line that there was [N]
    double exact_moment = 0.0;    ///< there, about the centre of mass and the x axis [N m]
    double force_per_draft = 0.0; ///< [N/m]
    double seconds = 0.0;
    ValidationPicture picture;
};

Held hold(const FloatingBody& hull, double heel, double spacing, const ValidationOptions& options)
{
    FluidWorldSettings settings;
    settings.particle_spacing = spacing;
    settings.threads = options.threads;
    settings.start = FluidWorldSettings::Start::at_rest;
    FluidWorld water(settings);
    const Vec3d tank(kHull.length + kHull.breadth, 2.5 * kHull.breadth, 2.5 * kHull.draft);
    water.add_box_wall({Vec3d::Zero(), Vec3d(tank.x(), tank.y(), 2.0 * tank.z())}, {"+z"});
    water.add_block({Vec3d::Zero(), tank});

    Pose pose = flotation(hull, Quatd(Eigen::AngleAxisd(heel * kDegree, Vec3d::UnitX()))).value().pose; // of the mesh
    pose.position += Vec3d(0.5 * tank.x(), 0.5 * tank.y(), tank.z());
    water.add_body(transformed(hull.mesh, Pose{-hull.center_of_mass, Quatd::Identity()}));
    const BodyState state{{pose.to_world(hull.center_of_mass), pose.orientation}, Twist{}};
    HeldBodies held({state.pose});

    Held out;
    while (water.time() < 0.25) {
        const StepReport step = water.step(water.allowed_time_step(), held);
        out.wrench += water.fluid_wrench(0) * step.dt;
    }
    out.wrench = out.wrench * (1.0 / water.time());
    out.seconds = water.time();
    const Submerged under = submerged_part(hull.mesh, pose, water.waterline(std::span(&state, 1)).value_or(NAN));
    out.exact_buoyancy = kWater * kGravity * under.volume;
    out.exact_moment = (under.center_of_buoyancy - pose.to_world(hull.center_of_mass)).y() *
                       out.exact_buoyancy; // upwards, seen from there
    out.force_per_draft = kWater * kGravity * under.waterplane_area;
    std::ostringstream caption;
    caption << "the hull at " << heel << " degrees";
    const PlacedMesh placed{&hull.mesh, pose};
    out.picture = take_picture(caption.str(), water, std::span(&placed, 1), options);
    return out;
}

/// Bands, as those of boxes and of drafts: for the arm 5 % of the largest up to 45 degrees, for the force what 0.24
/// spacings of draft are worth.
void compare(const Held& held, double heel, const FloatingBody& hull, double resolution, double wall_seconds,
             double band, ValidationResult& result)
{
    const double weight = hull.mass * kGravity;
    const double spacing = kHull.breadth / resolution;
    std::ostringstream at;
    at << ", heel " << heel << " deg";
    result.checks.push_back({"righting arm" + at.str(), "m", resolution, -held.wrench.angular.x() / weight,
                             -held.exact_moment / weight, band, spacing, held.seconds, wall_seconds});
    result.checks.push_back(
        {"upward force / exact buoyancy" + at.str(), "-", resolution, held.wrench.linear.z() / held.exact_buoyancy, 1.0,
         0.24 * spacing * held.force_per_draft / held.exact_buoyancy, std::nullopt, held.seconds, wall_seconds});
}

} // namespace

void run_righting_arm(const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kHeight = 0.1;
    const std::vector<double> angles =
        options.quick ? std::vector{10.0, 20.0, 45.0} : std::vector{5.0, 10.0, 15.0, 20.0, 30.0, 45.0};
    std::vector<double> degrees(46);
    std::iota(degrees.begin(), degrees.end(), 0.0);
    const double resolution = options.quick ? 10.0 : 20.0, spacing = kHeight / resolution;
    ValidationChart chart{
        "Righting arm of boxes of half the water's density, 0.1 m high", "heel [deg]", "arm [m]", {}, 0.0};
    for (const double width : {0.3, 0.2}) {
        const FloatingBody box = long_box(width, kHeight);
        std::ostringstream label;
        label << "B = " << width << " m";
        ValidationCurve measured{label.str() + ", measured", ValidationCurve::Kind::measured, angles, {}};
        const ValidationCurve theory{label.str() + ", theory", ValidationCurve::Kind::reference, degrees,
                                     exact_arms(box, degrees)};
        const std::vector<double> exact = exact_arms(box, angles);
        const double tolerance = 0.05 * *std::max_element(theory.y.begin(), theory.y.end());
        chart.band = std::max(chart.band, tolerance);
        for (std::size_t k = 0; k < angles.size(); ++k) {
            TankScene tank{.dimensions = 2, .spacing = spacing};
            tank.width = 4.0 * width;
            tank.level = 0.3;
            tank.height = 0.6;
            tank.duration = 2.0;
            std::ostringstream text;
            text << R"({"name": "box", "shape": {"box": [)" << width << ", " << kHeight
                 << R"(]}, "motion": "fixed", "position": [)" << 0.5 * tank.width << ", " << tank.level
                 << R"(], "rotation_deg": [0, )" << angles[k] << ", 0]}";
            tank.bodies = text.str();
            const RunReport report = run_unrecorded(tank.text(), options);
            const double weight = kWater * kGravity * 0.5 * width * kHeight;
            const double arm = -report.bodies.front().torque_fluid_mean.y() / weight;
            std::ostringstream quantity;
            quantity << label.str() << ", heel " << angles[k] << " deg";
            result.checks.push_back({quantity.str(), "m", resolution, arm, exact[k], tolerance, spacing,
                                     report.simulated_seconds, report.wall_seconds});
            measured.y.push_back(arm);
        }
        chart.curves.push_back(measured);
        chart.curves.push_back(theory);
    }
    result.charts.push_back(chart);
}

void run_wigley_heel(const ValidationOptions& options, ValidationResult& result)
{
    const FloatingBody hull = ballasted_hull();
    const std::vector<double> heels{15.0, 30.0, 45.0};
    std::vector<double> degrees(46);
    std::iota(degrees.begin(), degrees.end(), 0.0);
    const ValidationCurve theory{"theory", ValidationCurve::Kind::reference, degrees, exact_arms(hull, degrees)};
    ValidationChart chart{"Righting arm of a Wigley hull, 0.16 m broad", "heel [deg]", "arm [m]", {}, 0.0};
    chart.band = 0.05 * *std::max_element(theory.y.begin(), theory.y.end());
    for (const double resolution : options.quick ? std::vector{8.0} : std::vector{8.0, 12.0}) {
        std::ostringstream label;
        label << "measured, breadth of " << resolution << " spacings";
        ValidationCurve curve{label.str(), ValidationCurve::Kind::measured, heels, {}};
        for (std::size_t k = 0; k < heels.size(); ++k) {
            const Stopwatch watch;
            const Held held = hold(hull, heels[k], kHull.breadth / resolution, options);
            compare(held, heels[k], hull, resolution, watch.seconds(), chart.band, result);
            curve.y.push_back(result.checks[result.checks.size() - 2].value);
            result.pictures = {held.picture};
        }
        chart.curves.push_back(curve);
    }
    chart.curves.push_back(theory);
    result.charts.push_back(chart);
    result.notes.push_back(
        "Arms are the water's moment about the centre of mass over the hull's weight. They and the upward force are "
        "compared with those of the mesh at the water line as it stands in the tank, the force within what 0.24 "
        "spacings of draft are worth.");
}

} // namespace flotsam::validation
