// Milliseconds of a step by stage, for three sizes of a breaking dam (that of data/scenes/dam_break.json), either
// kernel, one thread and two, in one run (about five minutes). README's table of speeds is from here.
#include "flotsam/world/fluid_world.hpp"

#include <cstdio>

using namespace flotsam;

namespace {

struct Row {
    StageSeconds seconds;            ///< means a step
    double products = 0.0, dt = 0.0; ///< means
    std::size_t particles = 0;
};

/// Means over 20 steps of water that falls, after `warm_up` steps.
Row breaking_dam(double spacing, KernelKind kernel, int threads, int warm_up)
{
    constexpr int kSteps = 20;
    FluidWorldSettings settings;
    settings.particle_spacing = spacing;
    settings.threads = threads;
    settings.kernel = kernel;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(2.0, 0.5, 1.5)}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(0.6, 0.5, 0.8)});
    NoBodies none;
    for (int k = 0; k < warm_up; ++k) world.step(world.allowed_time_step(), none);
    Row row;
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = world.step(world.allowed_time_step(), none);
        row.seconds.neighbours += report.seconds.neighbours / kSteps;
        row.seconds.density += report.seconds.density / kSteps;
        row.seconds.forces += report.seconds.forces / kSteps;
        row.seconds.pressure += report.seconds.pressure / kSteps;
        row.seconds.advance += report.seconds.advance / kSteps;
        row.products += static_cast<double>(report.products) / kSteps;
        row.dt += report.dt / kSteps;
    }
    row.particles = world.fluid().size();
    return row;
}

} // namespace

int main()
{
    std::puts("| spacing | particles | kernel | threads | neighbours | density | forces | pressure | advance | all | "
              "products | dt | ns a particle |");
    std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (const double spacing : {0.022, 0.016, 0.0098})
        for (const KernelKind kernel : {KernelKind::quintic, KernelKind::cubic})
            for (const int threads : {1, 2}) {
                const Row row = breaking_dam(spacing, kernel, threads, spacing < 0.01 ? 20 : 40);
                const StageSeconds& s = row.seconds;
                const double all = s.neighbours + s.density + s.forces + s.pressure + s.advance;
                std::printf("| %.4g | %zu | %s | %d | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.0f |\n",
                            spacing, row.particles, kernel == KernelKind::quintic ? "quintic" : "cubic", threads,
                            1e3 * s.neighbours, 1e3 * s.density, 1e3 * s.forces, 1e3 * s.pressure, 1e3 * s.advance,
                            1e3 * all, row.products, 1e3 * row.dt, 1e9 * all / static_cast<double>(row.particles));
                std::fflush(stdout);
            }
}
