// Water without bodies: impact, stretching, waves, a dam that breaks. All in two dimensions.
#include "validation/case.hpp"

#include "flotsam/world/fluid_world.hpp"
#include "validation/take_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

namespace flotsam::validation {
namespace {

FluidWorldSettings plane_settings(double spacing, const ValidationOptions& options)
{
    FluidWorldSettings settings;
    settings.dimensions = 2;
    settings.particle_spacing = spacing;
    settings.threads = options.threads;
    return settings;
}

/// Steps with what the world allows, the last one so that it ends at `time`.
void step_until(FluidWorld& water, double time)
{
    NoBodies none;
    while (water.time() < time * (1.0 - 1e-9)) {
        const double left = time - water.time();
        water.step(left / std::ceil(left / water.allowed_time_step() * (1.0 - 1e-9)), none);
    }
}

double kinetic_energy(const FluidWorld& water)
{
    double sum = 0.0;
    for (const Vec4& v : water.fluid().velocity) sum += static_cast<double>(v.head<3>().squaredNorm());
    return 0.5 * water.fluid().particle_mass * sum;
}

// -- impact -----------------------------------------------------------------------------------------------------------

/// A rectangle, L along its motion and H wide, meets a wall all at once: what it loses of its kinetic energy after the
/// first steps, in which it has gone by half a spacing. The reference is the impact of an incompressible rectangle.
void run_patch_impact(const ValidationOptions& options, ValidationResult& result)
{
    struct Patch {
        double shape, loss; ///< L / H
    };
    constexpr std::array patches = {Patch{0.25, 0.7296}, Patch{0.5, 0.5000}, Patch{1.0, 0.2704}, Patch{2.0, 0.1357},
                                    Patch{4.0, 0.0678}};
    constexpr double kWidth = 1.0, kSpeed = 1.0;
    ValidationCurve theory{"theory", ValidationCurve::Kind::reference, {}, {}};
    ValidationChart chart{"Kinetic energy lost in the impact of a rectangle", "L / H", "part lost", {}, 0.03};
    for (const double resolution : options.quick ? std::vector{20.0} : std::vector{20.0, 40.0}) {
        const double spacing = kWidth / resolution;
        ValidationCurve curve{"measured", ValidationCurve::Kind::measured, {}, {}};
        for (const Patch& patch : patches) {
            const Stopwatch watch;
            FluidWorldSettings settings = plane_settings(spacing, options);
            settings.gravity = Vec3d::Zero();
            settings.max_time_step = 0.1 * spacing / kSpeed;
            FluidWorld water(settings);
            const double length = patch.shape * kWidth;
            water.add_box_wall({Vec3d(0, 0, -2.0 * kWidth), Vec3d(2.0 * length, 0, 2.0 * kWidth)}, {"+x", "+z", "-z"});
            water.add_block({Vec3d(0, 0, -0.5 * kWidth), Vec3d(length, 0, 0.5 * kWidth)}, Vec3d(-kSpeed, 0, 0));
            NoBodies none;
            water.prepare(none);
            const double before = kinetic_energy(water);
            step_until(water, 0.5 * spacing / kSpeed);
            std::ostringstream quantity;
            quantity << "part of the kinetic energy lost, L/H = " << patch.shape;
            result.checks.push_back({quantity.str(), "-", resolution, 1.0 - kinetic_energy(water) / before, patch.loss,
                                     0.03, std::nullopt, water.time(), watch.seconds()});
            curve.x.push_back(patch.shape);
            curve.y.push_back(result.checks.back().value);
        }
        std::ostringstream label;
        label << "measured, H of " << resolution << " spacings";
        curve.label = label.str();
        chart.curves.push_back(curve);
    }
    for (const Patch& patch : patches) {
        theory.x.push_back(patch.shape);
        theory.y.push_back(patch.loss);
    }
    chart.curves.push_back(theory);
    result.charts.push_back(chart);
}

// -- stretching -------------------------------------------------------------------------------------------------------

/// A disc of water in the velocity field (-A0 x, A0 z): its long half axis by potential theory (Monaghan 1994).
void run_elliptic_drop(const ValidationOptions& options, ValidationResult& result)
{
    constexpr std::array<double, 4> times = {0.2, 0.5, 0.76, 1.0}; ///< A0 t
    constexpr std::array<double, 4> axis = {1.2183, 1.5948, 1.9445, 2.2755};
    ValidationChart chart{"Long half axis of a stretching drop", "A0 t", "half axis / radius", {}, 0.0};
    for (const double resolution : options.quick ? std::vector{20.0} : std::vector{20.0, 40.0}) {
        const Stopwatch watch;
        const double spacing = 1.0 / resolution;
        FluidWorldSettings settings = plane_settings(spacing, options);
        settings.gravity = Vec3d::Zero();
        FluidWorld water(settings);
        const int reach = static_cast<int>(resolution);
        for (int a = -reach; a < reach; ++a)
            for (int b = -reach; b < reach; ++b) {
                const Vec3d at = spacing * Vec3d(a + 0.5, 0.0, b + 0.5);
                if (at.norm() < 1.0) water.add_particles(std::span(&at, 1), Vec3d(-at.x(), 0.0, at.z()));
            }
        std::ostringstream label;
        label << "measured, radius of " << resolution << " spacings";
        ValidationCurve curve{label.str(), ValidationCurve::Kind::measured, {}, {}};
        for (std::size_t k = 0; k < times.size(); ++k) {
            step_until(water, times[k]);
            double low = 0.0, high = 0.0;
            for (const Vec4& p : water.fluid().position) {
                low = std::min(low, static_cast<double>(p.z()));
                high = std::max(high, static_cast<double>(p.z()));
            }
            std::ostringstream quantity;
            quantity << "long half axis at A0 t = " << times[k];
            result.checks.push_back({quantity.str(), "m", resolution, 0.5 * (high - low + spacing), axis[k],
                                     0.03 * axis[k], spacing, times[k], watch.seconds()});
            curve.x.push_back(times[k]);
            curve.y.push_back(result.checks.back().value);
        }
        chart.curves.push_back(curve);
        result.pictures = {take_picture("the drop at A0 t = 1", water, {}, options)};
    }
    chart.curves.push_back(
        {"theory", ValidationCurve::Kind::reference, {times.begin(), times.end()}, {axis.begin(), axis.end()}});
    result.charts.push_back(chart);
}

// -- waves ------------------------------------------------------------------------------------------------------------

/// Velocity of the standing wave of wave number k in water of depth h, at its largest, 1 m/s up at x = 0.
Vec3d wave_velocity(const Vec3d& p, double k, double h)
{
    return Vec3d(-std::sin(k * p.x()) * std::cosh(k * p.z()), 0.0, std::cos(k * p.x()) * std::sinh(k * p.z())) /
           std::sinh(k * h);
}

/// Half a wave in a tank, started from a level surface with the velocities of linear theory: period, and what is left
/// of it after ten periods.
void run_standing_wave(const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kWavelength = 2.0, kDepth = 1.0, kAmplitude = 0.05;
    constexpr double kNumber = 2.0 * std::numbers::pi / kWavelength;
    const double exact = 2.0 * std::numbers::pi / std::sqrt(kGravity * kNumber * std::tanh(kNumber * kDepth));
    const double speed = kAmplitude * 2.0 * std::numbers::pi / exact;
    ValidationChart chart{"Standing wave: amplitude of its velocities", "periods", "amplitude / first", {}, 0.0};
    for (const double resolution : options.quick ? std::vector{60.0} : std::vector{30.0, 60.0, 80.0}) {
        const Stopwatch watch;
        const double spacing = kDepth / resolution, width = 0.5 * kWavelength;
        FluidWorld water(plane_settings(spacing, options));
        water.add_box_wall({Vec3d::Zero(), Vec3d(width, 0, 1.5 * kDepth)}, {"+z"});
        const int columns = static_cast<int>(std::lround(width / spacing));
        for (int a = 0; a < columns; ++a)
            for (int b = 0; b < static_cast<int>(resolution); ++b) {
                const Vec3d at = spacing * Vec3d(a + 0.5, 0.0, b + 0.5);
                water.add_particles(std::span(&at, 1), speed * wave_velocity(at, kNumber, kDepth));
            }
        std::vector<double> times, amplitudes, crossings;
        NoBodies none;
        while (water.time() < 10.3 * exact) {
            double along = 0.0, squares = 0.0;
            for (std::size_t i = 0; i < water.fluid().size(); ++i) {
                const Vec3d mode = wave_velocity(water.fluid().position[i].head<3>().cast<double>(), kNumber, kDepth);
                along += mode.dot(water.fluid().velocity[i].head<3>().cast<double>());
                squares += mode.squaredNorm();
            }
            times.push_back(water.time());
            amplitudes.push_back(along / squares / speed);
            if (times.size() > 1) {
                const double before = amplitudes[amplitudes.size() - 2], now = amplitudes.back();
                if (before * now < 0.0)
                    crossings.push_back(times.back() - (times.back() - times[times.size() - 2]) * now / (now - before));
            }
            water.step(water.allowed_time_step(), none);
        }
        const std::size_t many = std::min<std::size_t>(crossings.size(), 8);
        const double period =
            many < 2 ? NAN : 2.0 * (crossings[many - 1] - crossings[0]) / static_cast<double>(many - 1);
        double left = 0.0;
        for (std::size_t k = 0; k < times.size(); ++k)
            if (times[k] > 9.5 * exact) left = std::max(left, std::abs(amplitudes[k]));
        result.checks.push_back(
            {"period", "s", resolution, period, exact, 0.02 * exact, std::nullopt, water.time(), watch.seconds()});
        result.checks.push_back({"amplitude after ten periods / first", "-", resolution, left, 1.0, 0.5, std::nullopt,
                                 water.time(), watch.seconds()});
        std::ostringstream label;
        label << "measured, depth of " << resolution << " spacings";
        ValidationCurve curve{label.str(), ValidationCurve::Kind::measured, times, amplitudes};
        for (double& t : curve.x) t /= exact;
        chart.curves.push_back(curve);
    }
    ValidationCurve theory{"linear theory", ValidationCurve::Kind::reference, {}, {}};
    for (int k = 0; k <= 206; ++k) {
        theory.x.push_back(0.05 * k);
        theory.y.push_back(std::cos(2.0 * std::numbers::pi * theory.x.back()));
    }
    chart.curves.push_back(theory);
    result.charts.push_back(chart);
}

// -- a dam that breaks ------------------------------------------------------------------------------------------------

/// Where the front of a column, `a` wide and twice as high, is against two experiments, which scatter by 10 %.
/// **Source:** Koshizuka & Oka 1996; Martin & Moyce 1952 (a = 2.25 in).
void run_dam_break(const ValidationOptions& options, ValidationResult& result)
{
    constexpr std::array<double, 7> koshizuka_t = {0.769, 1.153, 1.537, 1.935, 2.323, 2.719, 3.096};
    constexpr std::array<double, 7> koshizuka_x = {1.252, 1.505, 1.892, 2.241, 2.615, 3.003, 3.624};
    constexpr std::array<double, 6> martin_t = {1.22, 2.00, 2.55, 3.35, 4.03, 5.09};
    constexpr std::array<double, 6> martin_x = {1.474, 2.292, 2.995, 4.134, 4.944, 6.980};
    constexpr double kWidth = 0.146, kLast = 3.4; // [m], in units of sqrt(a / 2g)
    const double unit = std::sqrt(kWidth / (2.0 * kGravity));
    ValidationChart chart{"Front of a breaking dam", "t sqrt(2 g / a)", "x / a", {}, 0.0};
    for (const double resolution : options.quick ? std::vector{16.0} : std::vector{16.0, 32.0}) {
        const Stopwatch watch;
        const double spacing = kWidth / resolution;
        FluidWorld water(plane_settings(spacing, options));
        water.add_box_wall({Vec3d::Zero(), Vec3d(6.0 * kWidth, 0, 3.0 * kWidth)}, {"+z"});
        water.add_block({Vec3d::Zero(), Vec3d(kWidth, 0, 2.0 * kWidth)});
        std::ostringstream label;
        label << "measured, column " << resolution << " spacings wide";
        ValidationCurve curve{label.str(), ValidationCurve::Kind::measured, {0.0}, {1.0}};
        NoBodies none;
        while (water.time() < kLast * unit) {
            water.step(water.allowed_time_step(), none);
            double front = 0.0;
            for (const Vec4& p : water.fluid().position) front = std::max(front, static_cast<double>(p.x()));
            curve.x.push_back(water.time() / unit);
            curve.y.push_back((front + 0.5 * spacing) / kWidth);
        }
        const auto compare = [&](const char* who, std::span<const double> t, std::span<const double> x) {
            for (std::size_t k = 0; k < t.size(); ++k) {
                if (t[k] > kLast) break;
                std::ostringstream quantity;
                quantity << "front x / a at " << t[k] << ", " << who;
                result.checks.push_back({quantity.str(), "-", resolution, interpolated(curve.x, curve.y, t[k]), x[k],
                                         0.1 * x[k], std::nullopt, water.time(), watch.seconds()});
            }
        };
        compare("Koshizuka & Oka", koshizuka_t, koshizuka_x);
        compare("Martin & Moyce", martin_t, martin_x);
        result.pictures = {take_picture("the water at t sqrt(2 g / a) = 3.4", water, {}, options)};
        chart.curves.push_back(curve);
    }
    const auto experiment = [&](const char* who, std::span<const double> t, std::span<const double> x) {
        ValidationCurve curve{who, ValidationCurve::Kind::experiment, {}, {}};
        for (std::size_t k = 0; k < t.size() && t[k] <= kLast; ++k) {
            curve.x.push_back(t[k]);
            curve.y.push_back(x[k]);
        }
        chart.curves.push_back(curve);
    };
    experiment("Koshizuka & Oka 1996", koshizuka_t, koshizuka_x);
    experiment("Martin & Moyce 1952", martin_t, martin_x);
    result.charts.push_back(chart);
}

constexpr std::array kCases = {
    Case{"patch_impact", "fluid alone", "A rectangle of water meets a wall", 10.0, 20.0, run_patch_impact},
    Case{"elliptic_drop", "fluid alone", "A drop is stretched", 10.0, 20.0, run_elliptic_drop},
    Case{"standing_wave", "fluid alone", "A standing wave", 10.0, 40.0, run_standing_wave},
    Case{"dam_break", "fluid alone", "A dam breaks", 10.0, 20.0, run_dam_break},
};

} // namespace

std::span<const Case> fluid_cases()
{
    return kCases;
}

} // namespace flotsam::validation
