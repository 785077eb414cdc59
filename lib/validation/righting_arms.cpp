// Bodies held at a heel in the water: the moment that turns them back, against exact clipping of their meshes.
#include "validation/righting_arms.hpp"

#include "flotsam/geometry/flotation.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "validation/case.hpp"

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

} // namespace flotsam::validation
