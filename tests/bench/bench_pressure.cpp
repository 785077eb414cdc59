// Iterations, products with A (what a solve costs: the eigenvalue's estimate, restarts and expansions included) and
// time of the pressure solvers over depth, tolerance, density ratio and time step, as a table of Markdown. Each row is
// one run with either solver, steps 61 to 120 of water that starts from its lattice; 40 spacings wide in 2-D, 16 in
// 3-D, a square of 8 or a cube of 6 spacings floats in it where a density ratio stands; max_iterations 2000.
//
// Measured with one thread (times on a machine that did other things too, so that iterations and products say more):
//
// clang-format off
// | | layers | tolerance | density ratio | dt [ms] | iterations iisph, mprgp | products | ms a step | ratio | unconverged |
// |---|---|---|---|---|---|---|---|---|---|
// | 2-D | 10 | 1e-03 | 0 | 4.8 | 11.7, 7.0 | 15.8, 11.3 | 1.1, 1.2 | 0.90 | 0, 0 |
// | 2-D | 30 | 1e-03 | 0 | 2.7 | 16.7, 8.0 | 21.2, 12.7 | 3.9, 3.2 | 1.21 | 0, 0 |
// | 2-D | 60 | 1e-03 | 0 | 1.9 | 43.1, 15.1 | 47.8, 19.4 | 12.2, 7.3 | 1.66 | 0, 0 |
// | 2-D | 100 | 1e-03 | 0 | 1.5 | 65.9, 31.2 | 71.5, 35.7 | 24.4, 22.6 | 1.08 | 0, 0 |
// | 2-D | 30 | 1e-02 | 0 | 2.7 | 11.9, 5.7 | 15.9, 9.8 | 3.4, 3.2 | 1.08 | 0, 0 |
// | 2-D | 30 | 1e-04 | 0 | 2.7 | 68.4, 18.9 | 73.6, 24.1 | 7.9, 5.0 | 1.58 | 0, 0 |
// | 2-D | 30 | 1e-05 | 0 | 2.7 | 280.6, 47.1 | 286.6, 56.5 | 23.5, 8.4 | 2.78 | 0, 0 |
// | 2-D | 30 | 1e-03 | 0.001 | 2.7 | 16.7, 9.9 | 21.2, 14.5 | 3.9, 3.9 | 1.02 | 0, 0 |
// | 2-D | 30 | 1e-03 | 0.01 | 2.7 | 17.2, 7.5 | 21.6, 12.5 | 3.8, 3.7 | 1.05 | 0, 0 |
// | 2-D | 30 | 1e-03 | 0.1 | 2.7 | 16.7, 7.6 | 21.2, 12.2 | 3.9, 3.6 | 1.08 | 0, 0 |
// | 2-D | 30 | 1e-03 | 0.5 | 2.7 | 17.3, 8.3 | 21.8, 12.8 | 3.9, 3.6 | 1.08 | 0, 0 |
// | 2-D | 30 | 1e-03 | 1 | 2.7 | 17.6, 8.1 | 22.1, 13.2 | 3.8, 3.5 | 1.06 | 0, 0 |
// | 2-D | 30 | 1e-03 | 10 | 2.2 | 74.5, 22.0 | 80.5, 38.7 | 8.5, 5.9 | 1.44 | 0, 0 |
// | 2-D | 30 | 1e-03 | 20 | 2.0 | 78.7, 21.3 | 84.7, 38.4 | 7.0, 6.0 | 1.16 | 0, 0 |
// | 2-D | 10 | 1e-03 | 0 | 1.0 | 2.8, 2.8 | 6.8, 6.8 | 0.7, 0.9 | 0.79 | 0, 0 |
// | 2-D | 10 | 1e-03 | 0 | 2.0 | 2.7, 2.1 | 6.7, 6.2 | 0.8, 0.9 | 0.95 | 0, 0 |
// | 2-D | 10 | 1e-03 | 0 | 4.0 | 8.2, 4.7 | 12.3, 8.9 | 1.0, 1.0 | 1.00 | 0, 0 |
// | 3-D | 10 | 1e-03 | 0 | 4.5 | 6.3, 4.4 | 10.4, 9.1 | 24.9, 23.6 | 1.05 | 0, 0 |
// | 3-D | 30 | 1e-03 | 0 | 2.5 | 14.2, 7.7 | 18.5, 16.8 | 43.6, 42.9 | 1.02 | 0, 0 |
// | 3-D | 20 | 1e-03 | 0.001 | 3.1 | 8.2, 6.3 | 12.5, 13.9 | 25.8, 26.5 | 0.97 | 0, 0 |
// | 3-D | 20 | 1e-03 | 0.5 | 3.1 | 7.7, 5.8 | 12.1, 13.4 | 24.9, 25.7 | 0.97 | 0, 0 |
// | 3-D | 20 | 1e-03 | 10 | 1.5 | 52.8, 31.0 | 58.5, 64.9 | 46.8, 51.5 | 0.91 | 0, 0 |
// clang-format on
//
// Hence MPRGP is the default: about half of the products of relaxed Jacobi at 60 to 100 layers and for heavy bodies in
// 2-D, a fifth at a tolerance of 1e-5, about as many where either is cheap. It takes a tenth more on shallow water in
// 3-D, where a step does not turn on either.
//
// Tried and rejected:
// - A multilevel preconditioner (cells of the neighbour grid as first coarse level, Galerkin matrix K^T K formed cell
// by
//   cell, W-cycle with Gauss-Seidel down to a dense factorization, added to the diagonal): after a disc
//   was let go in 70 layers, 14 to 16 iterations instead of 15 to 23 at a tolerance of 2e-6, without the matrices'
//   cost; first steps from the lattice, 90 layers, more than 2000 instead of 818. What is left after the first
//   iterations is rough on the scale of a spacing, where the kernel's spectrum is nearly zero, and in the first steps a
//   fifth of the particles carry no pressure in between of those that do, which no coarse field knows.
// - Projecting the whole conjugate gradient step instead of the half step with a fixed length, which saves the estimate
//   of the eigenvalue: 48 iterations a step instead of 29 for a column of 104 layers that comes to rest.
// - Steps over all particles that are not bound (also those at zero that want to rise) in place of proportioning:
//   it converges to the tolerance with rough pressures, and a held body felt 0.59 of its buoyancy.
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/free_bodies.hpp"

#include <array>
#include <chrono>
#include <cstdio>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.02;

struct Case {
    int dimensions = 2;
    int layers = 30;          ///< depth in spacings
    double tolerance = 1e-3;  ///< of the density; that of the velocity is a fiftieth of it
    double density_ratio = 0; ///< of a square or cube of 8 or 6 spacings that floats in it; 0: none
    double time_step = 0.008; ///< [s], cut to what the fluid allows
};

struct Cost {
    double iterations = 0.0, products = 0.0, milliseconds = 0.0; ///< per step
    double time_step = 0.0;                                      ///< mean [s]
    int unconverged = 0;
};

Cost run(const Case& c, PressureSettings::Solver solver)
{
    FluidWorldSettings settings;
    settings.dimensions = c.dimensions;
    settings.particle_spacing = kSpacing;
    settings.threads = 1;
    settings.max_time_step = c.time_step;
    settings.pressure.solver = solver;
    settings.pressure.tolerance = c.tolerance;
    settings.pressure.velocity_tolerance = c.tolerance / 50.0;
    settings.pressure.max_iterations = 2000;
    const bool plane = c.dimensions == 2;
    const double width = (plane ? 40 : 16) * kSpacing, depth = c.layers * kSpacing, thick = plane ? 1.0 : width;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(width, thick, depth + 0.4)}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(width, thick, depth)});
    FreeBodies bodies({}, settings.gravity);
    if (c.density_ratio > 0.0) {
        const double edge = (plane ? 8 : 6) * kSpacing;
        const Vec3d edges(edge, plane ? 1.0 : edge, edge);
        world.add_body(tessellate(BoxShape{edges}, 0.5 * kSpacing));
        const double middle = depth + (0.5 - std::min(1.0, c.density_ratio)) * edge;
        bodies.bodies.push_back(
            free_box(edges, 1000.0 * c.density_ratio, Vec3d(width / 2, plane ? 0.0 : width / 2, middle)));
    }
    const auto step = [&] { return world.step(world.allowed_time_step(), bodies); };
    for (int k = 0; k < 60; ++k) step();
    Cost cost;
    constexpr int kSteps = 60;
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = step();
        cost.iterations += static_cast<double>(report.iterations + report.shift_iterations) / kSteps;
        cost.products += static_cast<double>(report.products) / kSteps;
        cost.time_step += report.dt / kSteps;
        cost.unconverged += report.converged ? 0 : 1;
    }
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    cost.milliseconds = spent.count() / kSteps;
    return cost;
}

void print_row(const Case& c)
{
    using Solver = PressureSettings::Solver;
    const std::array<Cost, 3> costs = {run(c, Solver::iisph), run(c, Solver::mprgp), run(c, Solver::spg)};
    std::printf("| %d-D | %d | %.0e | %g | %.1f |", c.dimensions, c.layers, c.tolerance, c.density_ratio,
                1e3 * costs[2].time_step);
    const auto print = [&](const char* format, auto value) {
        for (std::size_t k = 0; k < costs.size(); ++k) {
            std::printf(k == 0 ? " " : ", ");
            std::printf(format, value(costs[k]));
        }
        std::printf(" |");
    };
    print("%.1f", [](const Cost& cost) { return cost.iterations; });
    print("%.1f", [](const Cost& cost) { return cost.products; });
    print("%.2f", [](const Cost& cost) { return cost.milliseconds; });
    print("%d", [](const Cost& cost) { return cost.unconverged; });
    std::puts("");
    std::fflush(stdout);
}

} // namespace

int main()
{
    std::puts(
        "| | layers | tolerance | density ratio | dt [ms] | iterations iisph, mprgp, spg | products | ms a step | "
        "unconverged |");
    std::puts("|---|---|---|---|---|---|---|---|---|");
    for (const int layers : {10, 30, 60, 100}) print_row({.layers = layers});
    for (const double tolerance : {1e-2, 1e-4, 1e-5}) print_row({.tolerance = tolerance});
    for (const double ratio : {0.001, 0.01, 0.1, 0.5, 1.0, 10.0, 20.0}) print_row({.density_ratio = ratio});
    for (const double dt : {0.001, 0.002, 0.004}) print_row({.layers = 10, .time_step = dt});
    for (const int layers : {10, 30}) print_row({.dimensions = 3, .layers = layers});
    for (const double ratio : {0.001, 0.5, 10.0}) print_row({.dimensions = 3, .layers = 20, .density_ratio = ratio});
}
