#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

using namespace flotsam;
using namespace flotsam::test;

namespace {

/// A cube of 8 spacings that slides along still water at 5 cm/s; its speed after two seconds [m/s].
double speed_after_sliding(double density_ratio, double kinematic_viscosity)
{
    constexpr double kSpacing = 0.04, kEdge = 8.0 * kSpacing, kDepth = 8.0 * kSpacing;
    const Vec3d tank(2.5 * kEdge, 2.0 * kEdge, 2.0 * kDepth);
    FluidWorldSettings settings;
    settings.particle_spacing = kSpacing;
    settings.kinematic_viscosity = kinematic_viscosity;
    settings.start = FluidWorldSettings::Start::at_rest;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), tank}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(tank.x(), tank.y(), kDepth)});
    world.add_body(tessellate(BoxShape{Vec3d::Constant(kEdge)}, kSpacing));
    FreeBody cube = free_box(Vec3d::Constant(kEdge), 1000.0 * density_ratio,
                             Vec3d(0.4 * tank.x(), 0.5 * tank.y(), kDepth + (0.5 - density_ratio) * kEdge));
    cube.momentum = Vec3d(0.05 * cube.mass, 0, 0);
    FreeBodies bodies({cube}, settings.gravity);
    while (world.time() < 2.0) world.step(world.allowed_time_step(), bodies);
    return bodies.bodies[0].twist().linear.head<2>().norm();
}

} // namespace

TEST_CASE("a cube as light as a balloon does not slide along water as if on air", "[property]")
{
    CHECK(speed_after_sliding(0.001, 1e-6) < 0.015);
    CHECK(speed_after_sliding(0.001, 0.0) > 0.03);
}
