// Iterations and time of the pressure solvers over depth, tolerance, density ratio and time step, as tables of
// Markdown. Each row is one run, in which both solvers start from the same settled water.
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/free_bodies.hpp"

#include <chrono>
#include <cstdio>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.02;

struct Case {
    int layers = 20;          ///< depth in spacings
    double tolerance = 1e-3;  ///< of the density; that of the velocity is a fiftieth of it
    double density_ratio = 0; ///< of a cube of 6 spacings that floats in it; 0: none
    double time_step = 0.004; ///< [s], cut to what the fluid allows
};

struct Cost {
    double iterations = 0.0, milliseconds = 0.0; ///< per step
    int unconverged = 0;
};

Cost run(const Case& c, PressureSettings::Solver solver)
{
    FluidWorldSettings settings;
    settings.particle_spacing = kSpacing;
    settings.max_time_step = c.time_step;
    settings.pressure.solver = solver;
    settings.pressure.tolerance = c.tolerance;
    settings.pressure.velocity_tolerance = c.tolerance / 50.0;
    settings.pressure.max_iterations = 2000;
    const double width = (c.density_ratio > 0.0 ? 16 : 10) * kSpacing, depth = c.layers * kSpacing;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(width, width, depth + 0.4)}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(width, width, depth)});
    FreeBodies bodies({}, settings.gravity);
    if (c.density_ratio > 0.0) {
        const Vec3d edges = Vec3d::Constant(6 * kSpacing);
        world.add_body(tessellate(BoxShape{edges}, 0.5 * kSpacing));
        const double middle = depth + (0.5 - std::min(1.0, c.density_ratio)) * edges.z();
        bodies.bodies.push_back(free_box(edges, 1000.0 * c.density_ratio, Vec3d(width / 2, width / 2, middle)));
    }
    const auto step = [&] { return world.step(world.allowed_time_step(), bodies); };
    for (int k = 0; k < 40; ++k) step();
    Cost cost;
    constexpr int kSteps = 60;
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = step();
        cost.iterations += static_cast<double>(report.iterations + report.shift_iterations) / kSteps;
        cost.unconverged += report.converged ? 0 : 1;
    }
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    cost.milliseconds = spent.count() / kSteps;
    return cost;
}

void print_row(const Case& c)
{
    const Cost jacobi = run(c, PressureSettings::Solver::iisph), krylov = run(c, PressureSettings::Solver::mprgp);
    std::printf("| %3d | %.0e | %5g | %g | %.1f | %.1f | %.1f | %.1f | %.2f | %d, %d |\n", c.layers, c.tolerance,
                c.density_ratio, 1e3 * c.time_step, jacobi.iterations, krylov.iterations, jacobi.milliseconds,
                krylov.milliseconds, jacobi.milliseconds / krylov.milliseconds, jacobi.unconverged, krylov.unconverged);
    std::fflush(stdout);
}

} // namespace

int main()
{
    std::puts(
        "| layers | tolerance | density ratio | dt [ms] | iterations iisph | mprgp | ms a step iisph | mprgp | ratio | "
        "unconverged |");
    std::puts("|---|---|---|---|---|---|---|---|---|---|");
    for (const int layers : {10, 30, 60, 100}) print_row({.layers = layers});
    for (const double tolerance : {1e-2, 1e-4, 1e-5}) print_row({.tolerance = tolerance});
    for (const double ratio : {0.001, 0.01, 0.1, 0.5, 1.0, 10.0}) print_row({.density_ratio = ratio});
    for (const double dt : {0.001, 0.002}) print_row({.time_step = dt});
}
