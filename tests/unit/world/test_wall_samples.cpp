#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.05, kLength = 8.0; ///< 160 spacings: five parts

/// A long trough with water at its low end, that flows along it.
FluidWorld trough(int threads, double speed)
{
    FluidWorldSettings s;
    s.particle_spacing = kSpacing;
    s.threads = threads;
    FluidWorld fluid(s);
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(kLength, 0.3, 0.4)}, {"+z"});
    fluid.add_block({Vec3d(0.1, 0, 0), Vec3d(0.6, 0.3, 0.2)}, Vec3d(speed, 0, 0));
    return fluid;
}

double farthest_sample(const FluidWorld& fluid)
{
    double farthest = 0.0;
    for (const Vec4& p : fluid.boundary().position) farthest = std::max(farthest, static_cast<double>(p.x()));
    return farthest;
}

double farthest_particle(const FluidWorld& fluid)
{
    double farthest = 0.0;
    for (const Vec4& p : fluid.fluid().position) farthest = std::max(farthest, static_cast<double>(p.x()));
    return farthest;
}

} // namespace

TEST_CASE("walls have samples where water is, and get them before it comes", "[world]")
{
    FluidWorld fluid = trough(1, 6.0), twin = trough(2, 6.0);
    FreeBodies none({}, Vec3d(0, 0, -9.81));
    fluid.step(fluid.allowed_time_step(), none);
    twin.step(twin.allowed_time_step(), none);
    const std::size_t at_first = fluid.boundary().size();
    CHECK(farthest_sample(fluid) < 0.5 * kLength);
    REQUIRE(at_first > 500);
    while (farthest_particle(fluid) < 0.9 * kLength) {
        REQUIRE(fluid.time() < 2.0);
        const double dt = fluid.allowed_time_step();
        const StepReport report = fluid.step(dt, none);
        CHECK(report.leaked == 0);
        twin.step(dt, none);
        // Four spacings and a step ahead.
        CHECK(farthest_sample(fluid) > std::min(kLength, farthest_particle(fluid) + 2.7 * kSpacing - 8.0 * dt));
    }
    CHECK(fluid.boundary().size() > 3 * at_first);
    CHECK(farthest_sample(fluid) > 0.95 * kLength);
    CHECK(fluid.state_hash() == twin.state_hash());
}
