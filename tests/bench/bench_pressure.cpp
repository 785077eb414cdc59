// Iterations, products with A (what a solve costs: the eigenvalue's estimate, restarts and expansions included) and
// time of the pressure solvers over depth, tolerance, density ratio and time step, as a table of Markdown. Each row is
// one run with either solver, steps 61 to 120 of water that starts from its lattice; 40 spacings wide in 2-D, 16 in
// 3-D, a square of 8 or a cube of 6 spacings floats in it where a density ratio stands; max_iterations 2000.
//
// Measured with one thread, on AVX-512 (1 min 14 s):
//
// clang-format off
// | | layers | tolerance | density ratio | dt [ms] | iterations iisph, mprgp, spg | products | ms a step | unconverged |
// |---|---|---|---|---|---|---|---|---|
// | 2-D | 10 | 1e-03 | 0 | 4.8 | 11.6, 7.2, 7.2 | 15.8, 11.6, 8.2 | 0.37, 0.45, 0.34 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 0 | 2.7 | 7.6, 7.2, 4.9 | 12.0, 12.1, 5.9 | 0.96, 1.12, 0.74 | 0, 0, 0 |
// | 2-D | 60 | 1e-03 | 0 | 1.9 | 24.5, 12.8, 11.6 | 29.0, 17.4, 12.6 | 3.49, 3.48, 2.07 | 0, 0, 0 |
// | 2-D | 100 | 1e-03 | 0 | 1.5 | 60.6, 30.4, 13.5 | 64.7, 35.3, 14.5 | 10.64, 8.43, 3.79 | 0, 0, 0 |
// | 2-D | 30 | 1e-02 | 0 | 2.7 | 5.5, 3.6, 3.6 | 9.6, 7.7, 4.7 | 0.85, 0.87, 0.74 | 0, 0, 0 |
// | 2-D | 30 | 1e-04 | 0 | 2.7 | 67.9, 18.5, 19.5 | 73.2, 23.8, 20.5 | 3.54, 1.85, 1.50 | 0, 0, 0 |
// | 2-D | 30 | 1e-05 | 0 | 2.7 | 1464.3, 46.0, 57.6 | 1467.3, 55.2, 58.6 | 60.98, 3.57, 3.10 | 1, 0, 0 |
// | 2-D | 30 | 1e-03 | 0.001 | 2.7 | 7.7, 6.6, 4.8 | 12.1, 11.2, 5.8 | 1.00, 1.14, 0.78 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 0.01 | 2.7 | 8.0, 4.9, 4.9 | 12.3, 9.9, 5.9 | 1.01, 1.04, 0.78 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 0.1 | 2.7 | 7.6, 5.1, 5.0 | 12.1, 9.9, 6.0 | 1.00, 1.04, 0.78 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 0.5 | 2.7 | 8.2, 5.4, 4.8 | 12.6, 10.2, 5.8 | 1.00, 1.04, 0.77 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 1 | 2.7 | 8.8, 5.9, 5.5 | 13.3, 11.4, 6.5 | 1.01, 1.08, 0.78 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 10 | 2.2 | 74.9, 22.3, 23.6 | 80.9, 38.9, 24.6 | 3.80, 2.34, 1.55 | 0, 0, 0 |
// | 2-D | 30 | 1e-03 | 20 | 2.1 | 77.7, 22.1, 26.1 | 83.7, 39.6, 27.1 | 3.66, 2.34, 1.64 | 0, 0, 0 |
// | 2-D | 10 | 1e-03 | 0 | 1.0 | 1.8, 2.1, 1.4 | 5.9, 6.2, 2.4 | 0.23, 0.25, 0.19 | 0, 0, 0 |
// | 2-D | 10 | 1e-03 | 0 | 2.0 | 1.9, 1.9, 1.7 | 5.8, 6.1, 2.6 | 0.23, 0.25, 0.19 | 0, 0, 0 |
// | 2-D | 10 | 1e-03 | 0 | 4.0 | 8.2, 5.1, 5.5 | 12.3, 9.3, 6.5 | 0.32, 0.32, 0.25 | 0, 0, 0 |
// | 3-D | 10 | 1e-03 | 0 | 4.5 | 6.3, 4.3, 4.4 | 10.4, 9.0, 5.4 | 4.93, 5.28, 4.04 | 0, 0, 0 |
// | 3-D | 30 | 1e-03 | 0 | 2.5 | 8.4, 5.0, 5.3 | 13.0, 12.8, 6.3 | 17.25, 21.67, 14.77 | 0, 0, 0 |
// | 3-D | 20 | 1e-03 | 0.001 | 3.1 | 7.5, 5.0, 5.0 | 11.8, 12.1, 6.0 | 13.71, 15.07, 10.98 | 0, 0, 0 |
// | 3-D | 20 | 1e-03 | 0.5 | 3.1 | 7.1, 5.3, 4.7 | 11.4, 13.1, 5.7 | 14.01, 12.80, 10.70 | 0, 0, 0 |
// | 3-D | 20 | 1e-03 | 10 | 1.5 | 44.0, 29.4, 19.6 | 49.6, 62.0, 20.6 | 24.44, 31.47, 14.46 | 0, 0, 0 |
// clang-format on
//
// Hence projected spectral gradients are the default: least time in every row, and products that grow slower than the
// root of the depth. MPRGP takes fewer iterations at tight tolerances, but two products for each in which a particle
// loses or gains its pressure. At the same tolerance spectral gradients leave more of the smooth errors; a little of
// the gain is given back for that (velocity_tolerance 1.5e-5, with MPRGP 2e-5).
//
// Tried and rejected:
// - Spectral gradients with conjugate gradients wherever no particle changed sides (as in GPCG, More & Toraldo 1991):
// 49
//   instead of 59 products at 1e-5, but 8 to 25 instead of 7 to 13 at 1e-3.
// - The first of Barzilai and Borwein's step lengths, both in turn, the smaller of them if it is under half of the
//   larger: 15.1, 14.7 and 12.4 products in a breaking dam, 11.5 with the second alone; 21, 45, 14 and 13 in 100
//   layers.
// - A start from pressures that go on as they went in the last step, p + b (p - p_before): 5.9, 5.6, 6.9 and 17.2
//   iterations in a breaking dam with b = 0, 0.3, 0.6 and 1: what changes from step to step is noise.
// - Their preconditioning by the bodies' response: nothing gained at any density ratio.
// - FISTA with restarts: 7.7 products a solve in a breaking dam, spectral gradients 6.5.
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
