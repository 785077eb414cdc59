// Seconds of a step by stage: one thread against two, and the cubic kernel against the quintic one, in one run.
#include "flotsam/world/fluid_world.hpp"

#include <cstdio>

using namespace flotsam;

namespace {

/// Mean over `steps` steps of a column of water that breaks, after as many to warm up.
StageSeconds breaking_dam(int threads, KernelKind kernel)
{
    constexpr int kSteps = 50;
    FluidWorldSettings settings;
    settings.threads = threads;
    settings.kernel = kernel;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(1.2, 0.4, 1.0)}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(0.5, 0.4, 0.6)});
    NoBodies none;
    for (int k = 0; k < kSteps; ++k) world.step(world.allowed_time_step(), none);
    StageSeconds sum;
    for (int k = 0; k < kSteps; ++k) {
        const StageSeconds s = world.step(world.allowed_time_step(), none).seconds;
        sum.neighbours += s.neighbours / kSteps;
        sum.density += s.density / kSteps;
        sum.forces += s.forces / kSteps;
        sum.pressure += s.pressure / kSteps;
        sum.advance += s.advance / kSteps;
    }
    return sum;
}

double print_row(const char* name, const StageSeconds& s)
{
    const double total = s.neighbours + s.density + s.forces + s.pressure + s.advance;
    std::printf("| %s | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |\n", name, 1e3 * s.neighbours, 1e3 * s.density,
                1e3 * s.forces, 1e3 * s.pressure, 1e3 * s.advance, 1e3 * total);
    return total;
}

} // namespace

int main()
{
    std::puts("15 000 particles, milliseconds a step\n");
    std::puts("| run | neighbours | density | forces | pressure | advance | all |");
    std::puts("|---|---|---|---|---|---|---|");
    const double one = print_row("quintic, 1 thread", breaking_dam(1, KernelKind::quintic));
    const double two = print_row("quintic, 2 threads", breaking_dam(2, KernelKind::quintic));
    const double cubic = print_row("cubic, 2 threads", breaking_dam(2, KernelKind::cubic));
    std::printf("\none thread / two threads %.2f, quintic / cubic %.2f\n", one / two, two / cubic);
}
