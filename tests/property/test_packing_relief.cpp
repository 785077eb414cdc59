#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <numbers>

using namespace flotsam;

namespace {

constexpr int kParticles = 40; ///< on an edge
constexpr double kSpacing = 0.02, kEdge = kParticles * kSpacing;

/// One turn that fills the tank, of unit speed.
Vec3d vortex(const Vec3d& p)
{
    const double x = std::numbers::pi * p.x() / kEdge, z = std::numbers::pi * p.z() / kEdge;
    return {std::sin(x) * std::cos(z), 0.0, -std::cos(x) * std::sin(z)};
}

struct Motion {
    double amplitude = 0.0; ///< of the vortex [m/s]
    double rms = 0.0;       ///< of the speeds [m/s]
};

/// A tank of water, 0.8 m deep, that starts as a vortex of `speed`, after a second.
Motion after_a_second(double speed, double packing_relief)
{
    FluidWorldSettings settings;
    settings.dimensions = 2;
    settings.particle_spacing = kSpacing;
    settings.packing_relief = packing_relief;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(kEdge, 1.0, 1.3 * kEdge)}, {"+z"});
    for (int a = 0; a < kParticles; ++a) {
        for (int c = 0; c < kParticles; ++c) {
            const Vec3d at = kSpacing * Vec3d(a + 0.5, 0.0, c + 0.5);
            world.add_particles(std::span<const Vec3d>(&at, 1), speed * vortex(at));
        }
    }
    NoBodies none;
    while (world.time() < 1.0) world.step(world.allowed_time_step(), none);
    double along = 0.0, modes = 0.0, squares = 0.0;
    const FluidState& fluid = world.fluid();
    for (std::size_t i = 0; i < fluid.size(); ++i) {
        const Vec3d v = fluid.velocity[i].head<3>().cast<double>();
        const Vec3d mode = vortex(fluid.position[i].head<3>().cast<double>());
        along += v.dot(mode);
        modes += mode.squaredNorm();
        squares += v.squaredNorm();
    }
    return {along / modes, std::sqrt(squares / static_cast<double>(fluid.size()))};
}

} // namespace

TEST_CASE("a vortex under pressure keeps its speed, for the packing's stress is taken away", "[property]")
{
    constexpr double kSpeed = 0.3;
    const Motion with = after_a_second(kSpeed, 1.0), without = after_a_second(kSpeed, 0.0);
    CAPTURE(with.amplitude, without.amplitude, with.rms, without.rms);
    CHECK(with.amplitude > 0.72 * kSpeed);
    CHECK(with.amplitude < kSpeed);
    CHECK(without.amplitude < 0.66 * kSpeed);
    CHECK(with.rms < std::sqrt(0.5) * kSpeed); // as the vortex started: no energy comes in
}

TEST_CASE("taking the packing's stress away does not stir still water", "[property]")
{
    // As much as is taken by default; later: "water comes to rest and stays there".
    const Motion with = after_a_second(0.0, FluidWorldSettings().packing_relief), without = after_a_second(0.0, 0.0);
    CAPTURE(with.rms, without.rms);
    CHECK(with.rms < 1.2 * without.rms); // of the lattice of the start, which falls into a packing
}
