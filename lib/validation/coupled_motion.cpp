// Bodies that move with the water: release under water, heave.
#include "validation/case.hpp"
#include "validation/driven_sphere.hpp"

#include <Eigen/Cholesky>

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

namespace flotsam::validation {
namespace {

constexpr std::array<double, 4> kRatios = {0.001, 0.1, 0.5, 0.8};

struct ReleasedBody {
    const char* name;
    const char* shape; ///< of 0.1 m in radius or half edge
    int dimensions;
    double added_mass; ///< of the displaced mass, in the tank
};

/// Acceleration (1 - s) / (s + Ca) g of a body let go under water, fitted to its speed over 0.02 to 0.1 s as far as it
/// has moved by less than a tenth of its size.
void release(const ReleasedBody& body, double resolution, const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kRadius = 0.1, kFarthest = 0.2 * kRadius;
    const double spacing = kRadius / resolution;
    ValidationCurve measured{body.name, ValidationCurve::Kind::measured, {}, {}};
    ValidationCurve theory{std::string(body.name) + ", theory", ValidationCurve::Kind::reference, {}, {}};
    for (const double ratio : kRatios) {
        const double exact = (1.0 - ratio) / (ratio + body.added_mass);
        TankScene tank{.dimensions = body.dimensions, .spacing = spacing};
        tank.width = body.dimensions == 2 ? 20.0 * kRadius : 6.0 * kRadius; // 9 and 2 radii of water beside it
        tank.depth = 6.0 * kRadius;
        tank.level = body.dimensions == 2 ? 12.0 * kRadius : 6.0 * kRadius;
        tank.height = 1.3 * tank.level;
        tank.frames_per_second = 500.0;
        // Until a body with two thirds of the acceleration would be there, and no longer than it counts.
        const double frames = std::sqrt(3.0 * kFarthest / (exact * kGravity)) * tank.frames_per_second;
        tank.duration = std::min(0.1, std::ceil(frames) / tank.frames_per_second);
        std::ostringstream text;
        text << R"({"name": "body", "shape": )" << body.shape << R"(, "density": )" << kWater * ratio
             << R"(, "position": [)" << 0.5 * tank.width << ", " << (body.dimensions == 3 ? 0.5 * tank.depth : 0.0)
             << ", " << 0.5 * tank.level << "]}";
        tank.bodies = text.str();
        const RecordedRun run = run_recorded(tank.text(), options);
        const std::vector<double>&t = run.column("t"), &z = run.column("body.z"), &v = run.column("body.vz");
        std::vector<double> times, speeds;
        for (std::size_t k = 0; k < t.size(); ++k) {
            if (t[k] < 0.02 - 1e-9 || z[k] - z[0] > kFarthest) continue;
            times.push_back(t[k]);
            speeds.push_back(v[k]);
        }
        std::ostringstream quantity;
        quantity << body.name << ", acceleration / g, s = " << ratio;
        result.checks.push_back({quantity.str(), "-", resolution, slope(times, speeds) / kGravity, exact, 0.1 * exact,
                                 std::nullopt, run.report.simulated_seconds, run.report.wall_seconds});
        measured.x.push_back(ratio);
        measured.y.push_back(result.checks.back().value);
        theory.x.push_back(ratio);
        theory.y.push_back(exact);
    }
    std::ostringstream title;
    title << "Acceleration of a " << body.name << " of " << resolution << " spacings in radius, let go under water";
    result.charts.push_back({title.str(), "density ratio", "acceleration / g", {measured, theory}, 0.0});
}

void run_release_2d(const ValidationOptions& options, ValidationResult& result)
{
    for (const ReleasedBody& body : {ReleasedBody{"disc", R"({"disc": 0.1})", 2, 1.0},
                                     ReleasedBody{"square", R"({"box": [0.2, 0.2]})", 2, 1.186}}) {
        if (!options.quick) release(body, 6.0, options, result);
        release(body, 10.0, options, result);
    }
}

void run_release_3d(const ValidationOptions& options, ValidationResult& result)
{
    // Of a sphere in water without bounds 1/2. Walls, floor and surface, each three radii from its centre, are images
    // of its dipole: Ca = 1/2 - 3/2 k, k = sum of the signs of the images times (3 z^2 / r^2 - 1) (R / r)^3 / 2 =
    // -0.0207.
    constexpr double kInTank = 0.531;
    for (const double resolution : {5.0, 10.0})
        release({"sphere", R"({"sphere": 0.1})", 3, kInTank}, resolution, options, result);
    result.notes.push_back("The reference is that of the tank, where the sphere has two radii of water on all sides: "
                           "walls take 2 to 6 % of the acceleration in water without bounds (added mass 0.531 instead "
                           "of 1/2 of the displaced mass).");
}

struct Extremum {
    double time, value;
};

/// Extrema of y(t), t evenly spaced: where the slope of the parabola that fits the samples within `window` of a time
/// best changes its sign. The crest of a heave is flat: single samples say little about when it was.
std::vector<Extremum> extrema(const std::vector<double>& t, const std::vector<double>& y, double window)
{
    std::vector<Extremum> found;
    double last_slope = 0.0;
    for (std::size_t k = 0; k < t.size(); ++k) {
        if (t[k] - window < t.front() || t[k] + window > t.back()) continue;
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (std::size_t m = 0; m < t.size(); ++m) {
            const double dt = t[m] - t[k];
            if (std::abs(dt) > window) continue;
            const Eigen::Vector3d powers(1.0, dt, dt * dt);
            normal += powers * powers.transpose();
            right += y[m] * powers;
        }
        const Eigen::Vector3d fit = normal.ldlt().solve(right); // value, slope and half the curvature at t[k]
        if (last_slope * fit[1] < 0.0) {
            const double to_vertex = -0.5 * fit[1] / fit[2];
            found.push_back({t[k] + to_vertex, fit[0] + 0.5 * fit[1] * to_vertex});
        }
        last_slope = fit[1];
    }
    return found;
}

/// z / z0 of the half-submerged disc by linear potential theory, T = t sqrt(g / R): computed for this project.
constexpr std::array<double, 14> kHeaveTime = {0.0, 0.5,  1.0, 1.5, 2.0,  2.5,  3.0,
                                               3.5, 3.72, 5.0, 7.0, 7.22, 10.0, 10.6};
constexpr std::array<double, 14> kHeave = {1.0,    0.922,  0.704,  0.390, 0.042, -0.276, -0.510,
                                           -0.627, -0.639, -0.323, 0.298, 0.305, -0.180, -0.212};

/// The disc let go from three heights, and the mean of what it does: the turn of a crest is flat, and one run's time of
/// it is off by 3 % either way.
void run_disc_heave(const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kRadius = 0.1;
    constexpr std::array<double, 3> kLifts = {0.02, 0.025, 0.03};
    ValidationChart chart{"Heave of a half-submerged disc", "t sqrt(g / R)", "z / z0", {}, 0.08};
    for (const double resolution : options.quick ? std::vector{10.0} : std::vector{7.0, 10.0, 14.0}) {
        ValidationCurve mean{"", ValidationCurve::Kind::measured, {}, {}};
        double trough = 0.0, period = 0.0, seconds = 0.0, wall_seconds = 0.0;
        for (const double lift : kLifts) {
            TankScene tank{.dimensions = 2,
                           .spacing = kRadius / resolution,
                           .width = 3.0,
                           .level = 0.6,
                           .height = 1.0,
                           .duration = 1.1,
                           .frames_per_second = 100.0};
            std::ostringstream text;
            text << R"({"name": "disc", "shape": {"disc": 0.1}, "density": 500, "position": [1.5, )"
                 << tank.level + lift << "]}";
            tank.bodies = text.str();
            const RecordedRun run = run_recorded(tank.text(), options);
            std::vector<double> t = run.column("t"), z = run.column("disc.z");
            for (double& value : t) value *= std::sqrt(kGravity / kRadius);
            for (double& value : z) value = (value - tank.level) / lift;
            const std::vector<Extremum> turns = extrema(t, z, 7.0 / 12.0);
            const double share = 1.0 / static_cast<double>(kLifts.size());
            trough += turns.empty() ? NAN : share * turns[0].value;
            period += turns.size() < 2 ? NAN : share * 2.0 * (turns[1].time - turns[0].time);
            seconds += run.report.simulated_seconds;
            wall_seconds += run.report.wall_seconds;
            mean.x = t;
            mean.y.resize(z.size(), 0.0);
            for (std::size_t k = 0; k < z.size(); ++k) mean.y[k] += share * z[k];
        }
        std::ostringstream label;
        label << "measured, R of " << resolution << " spacings";
        mean.label = label.str();
        const auto check = [&](const char* quantity, double value, double reference, double tolerance) {
            result.checks.push_back(
                {quantity, "-", resolution, value, reference, tolerance, std::nullopt, seconds, wall_seconds});
        };
        check("first trough z / z0", trough, -0.639, 0.08);
        check("period t sqrt(g / R)", period, 7.0, 0.35);
        check("z / z0 at t sqrt(g / R) = 1", interpolated(mean.x, mean.y, 1.0), 0.704, 0.08);
        chart.curves.push_back(mean);
    }
    chart.curves.push_back({"linear potential theory",
                            ValidationCurve::Kind::reference,
                            {kHeaveTime.begin(), kHeaveTime.end()},
                            {kHeave.begin(), kHeave.end()}});
    result.charts.push_back(chart);
}

/// Square boxes of half the water's density, held upright. Periods lie between 1.1 and 1.6 times 2 pi sqrt(draft / g),
/// by experiments.
void run_box_heave(const ValidationOptions& options, ValidationResult& result)
{
    for (const double draft : options.quick ? std::vector{0.05} : std::vector{0.05, 0.1, 0.2}) {
        constexpr double kResolution = 8.0; // of the draft
        const double without = 2.0 * std::numbers::pi * std::sqrt(draft / kGravity);
        TankScene tank{.dimensions = 2,
                       .spacing = draft / kResolution,
                       .width = 16.0 * draft,
                       .level = 8.0 * draft,
                       .height = 14.0 * draft,
                       .duration = 2.5 * without,
                       .frames_per_second = 40.0 / without};
        std::ostringstream text;
        text << R"({"name": "box", "shape": {"box": [)" << 2.0 * draft << ", " << 2.0 * draft
             << R"(]}, "density": 500, "lock": ["ry"], "position": [)" << 0.5 * tank.width << ", "
             << tank.level + 0.4 * draft << "]}";
        tank.bodies = text.str();
        const RecordedRun run = run_recorded(tank.text(), options);
        const std::vector<Extremum> turns = extrema(run.column("t"), run.column("box.z"), without / 10.0);
        const double period = turns.size() < 2 ? NAN : 2.0 * (turns[1].time - turns[0].time);
        std::ostringstream quantity;
        quantity << "period / 2 pi sqrt(draft / g), draft of " << draft << " m";
        result.checks.push_back({quantity.str(), "-", kResolution, period / without, 1.35, 0.25, std::nullopt,
                                 run.report.simulated_seconds, run.report.wall_seconds});
    }
}

constexpr std::array kCases = {
    Case{"release_2d", "coupled motion", "A disc and a square let go under water", 60.0, 100.0, run_release_2d},
    Case{"release_3d", "coupled motion", "A sphere let go under water", 0.0, 800.0, run_release_3d},
    Case{"added_mass", "coupled motion", "A sphere moved to and fro under water", 25.0, 150.0, run_added_mass},
    Case{"disc_heave", "coupled motion", "Heave of a half-submerged disc", 40.0, 250.0, run_disc_heave},
    Case{"box_heave", "coupled motion", "Heave period of a box", 20.0, 100.0, run_box_heave},
};

} // namespace

std::span<const Case> coupled_cases()
{
    return kCases;
}

} // namespace flotsam::validation
