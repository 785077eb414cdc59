#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

#include <numeric>

using namespace flotsam;
using namespace flotsam::test;

namespace {

/// A body that stands still or goes on at a velocity, whatever the water does.
class DrivenBody final : public Bodies {
  public:
    DrivenBody(const Vec3d& place, const Vec3d& velocity)
    {
        state_.pose.position = place;
        state_.predicted.linear = state_.start.linear = velocity;
    }
    [[nodiscard]] std::size_t size() const override { return 1; }
    void read(double dt, std::span<BodyState> states) override
    {
        dt_ = dt;
        states[0] = state_;
    }
    void respond(std::span<const Wrench>, std::span<Twist> twists) const override { twists[0] = {}; }
    void apply(std::span<const Wrench>) override { state_.pose.position += dt_ * state_.predicted.linear; }
    [[nodiscard]] const Pose& pose() const { return state_.pose; }

  private:
    BodyState state_;
    double dt_ = 0.0;
};

FluidWorldSettings settings_of(int dimensions)
{
    FluidWorldSettings s;
    s.dimensions = dimensions;
    s.particle_spacing = 0.02;
    s.threads = 1;
    return s;
}

/// Still water 0.32 m deep in an open tank 0.4 m wide.
void add_tank(FluidWorld& world)
{
    world.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.6)}, {"+z"});
    world.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.32)});
}

} // namespace

TEST_CASE("forces by cause add up to the wrench of the step, at any point", "[world][forces]")
{
    const int dimensions = GENERATE(2, 3);
    const bool moves = GENERATE(false, true);
    FluidWorldSettings settings = settings_of(dimensions);
    settings.kinematic_viscosity = 1e-3; // enough to be seen
    FluidWorld world(settings);
    add_tank(world);
    const Vec3d edges(0.1, dimensions == 2 ? 1.0 : 0.1, 0.1);
    world.add_body(tessellate(BoxShape{edges}, 0.02));
    DrivenBody body(Vec3d(0.15, dimensions == 2 ? 0.0 : 0.2, 0.17), moves ? Vec3d(0.3, 0, 0.02) : Vec3d::Zero());
    CHECK(world.fluid_forces(0).total().linear.norm() == 0.0); // before the first step
    CHECK(world.sample_forces(0).empty());
    for (int k = 0; k < 30; ++k) world.step(0.002, body);
    const double scale = world.fluid_wrench(0).linear.norm();
    REQUIRE(scale > 1.0);

    const FluidForces forces = world.fluid_forces(0);
    const Wrench total = world.fluid_wrench(0);
    CHECK((forces.total().linear - total.linear).norm() < 1e-12 * scale);
    CHECK((forces.total().angular - total.angular).norm() < 1e-12 * scale);
    if (moves) CHECK(forces.viscous.linear.norm() > 1e-3 * scale);
    CHECK((forces.packing.linear.norm() > 1e-3 * scale) == moves);

    // About another point each part turns by its own force, and back again is the same.
    const Vec3d point(0.3, -0.1, 0.7);
    const FluidForces there = world.fluid_forces(0, point);
    Vec3d center = body.pose().position; // apply has moved it on since
    if (moves) center -= 0.002 * Vec3d(0.3, 0, 0.02);
    const Vec3d arm = center - point;
    CHECK((there.hydrostatic.angular - forces.hydrostatic.angular - arm.cross(forces.hydrostatic.linear)).norm() <
          1e-12 * scale);
    CHECK((there.total().angular - total.angular - arm.cross(total.linear)).norm() < 1e-12 * scale);

    // The samples' forces are the same sum in another order: rounding of single precision.
    const std::vector<SampleForce> samples = world.sample_forces(0);
    REQUIRE(samples.size() >= 20);
    Wrench sum;
    double moved = 0.0;
    for (const SampleForce& s : samples) {
        sum += Wrench{s.force, (s.position - center).cross(s.force)};
        moved += s.force.norm();
    }
    CHECK((sum.linear - forces.pressure().linear).norm() < 1e-6 * moved);
    CHECK((sum.angular - forces.pressure().angular).norm() < 1e-6 * moved);
}

TEST_CASE("the hydrostatic part is Archimedes' for the exact mesh", "[world][forces]")
{
    const int dimensions = GENERATE(2, 3);
    const double middle = GENERATE(0.15, 0.32, 0.5); // under water, half under, above
    FluidWorld world(settings_of(dimensions));
    add_tank(world);
    const Vec3d edges(0.1, dimensions == 2 ? 1.0 : 0.1, 0.12);
    world.add_body(tessellate(BoxShape{edges}, 0.02));
    DrivenBody body(Vec3d(0.2, dimensions == 2 ? 0.0 : 0.2, middle), Vec3d::Zero());
    for (int k = 0; k < 5; ++k) world.step(0.002, body);
    BodyState state;
    body.read(0.002, {&state, 1});
    const double level = world.waterline({&state, 1}).value();
    CHECK(level == Approx(0.32).margin(0.02)); // what the body displaces was cut away
    const double under = std::clamp(level - (middle - 0.06), 0.0, 0.12);
    const Wrench part = world.fluid_forces(0).hydrostatic;
    CHECK(part.linear.z() == Approx(9810.0 * edges.x() * edges.y() * under).epsilon(1e-9));
    CHECK(part.linear.head<2>().norm() == 0.0);
    CHECK(part.angular.norm() < 1e-12);
}

TEST_CASE("without a water line the hydrostatic part is of the whole body, or nothing", "[world][forces]")
{
    FluidWorldSettings settings = settings_of(2);
    settings.gravity = GENERATE(Vec3d(0, 0, 0), Vec3d(3, 0, -9));
    FluidWorld world(settings);
    world.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.6)});
    world.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.32)});
    world.add_body(tessellate(BoxShape{Vec3d(0.1, 1.0, 0.1)}, 0.02));
    DrivenBody body(Vec3d(0.2, 0, 0.16), Vec3d::Zero());
    for (int k = 0; k < 5; ++k) world.step(0.002, body);
    const Wrench part = world.fluid_forces(0).hydrostatic;
    CHECK((part.linear + 1000.0 * 0.01 * settings.gravity).norm() < 1e-9);
}

TEST_CASE("pressure on a held box grows with depth and carries it", "[world][forces]")
{
    // 10 spacings each way and 6 under the surface; the mesh's triangles are about two spacings wide.
    const int dimensions = GENERATE(2, 3);
    CAPTURE(dimensions);
    FluidWorld world(settings_of(dimensions));
    const double d = 0.02, level = 0.44, edge = 0.2;
    const double y = dimensions == 2 ? 1.0 : edge;
    world.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.48, 0.48, 0.6)}, {"+z"});
    world.add_block({Vec3d(0, 0, 0), Vec3d(0.48, 0.48, level)});
    const TriangleMesh mesh = refined(tessellate(BoxShape{Vec3d(edge, y, edge)}, 1.0), 2.0 * d);
    world.add_body(mesh);
    const Vec3d place(0.24, dimensions == 2 ? 0.0 : 0.24, 0.22);
    DrivenBody body(place, Vec3d::Zero());
    while (world.time() < 0.4) world.step(world.allowed_time_step(), body);
    std::vector<double> mean(mesh.triangles.size(), 0.0);
    Vec3d force = Vec3d::Zero(), spread = Vec3d::Zero(), hydrostatic = Vec3d::Zero();
    int steps = 0;
    for (; world.time() < 0.8; ++steps) {
        world.step(world.allowed_time_step(), body);
        if (steps % 4 != 0) continue;
        const std::vector<double> pressure = world.surface_pressure(0);
        const FluidForces forces = world.fluid_forces(0);
        force += forces.pressure().linear;
        hydrostatic += forces.hydrostatic.linear;
        for (std::size_t t = 0; t < mean.size(); ++t) {
            const Vec3d u = mesh.corner(t, 1) - mesh.corner(t, 0), v = mesh.corner(t, 2) - mesh.corner(t, 0);
            spread -= 0.5 * pressure[t] * u.cross(v);
            mean[t] += pressure[t];
        }
    }
    const int readings = (steps + 3) / 4;
    for (double& p : mean) p /= readings;
    const double lift = hydrostatic.z();
    CAPTURE((spread - force).transpose() / lift, force.transpose() / lift);
    CHECK((spread - force).norm() < 0.015 * lift);  // 0.012 and less: samples along edges bear more than others
    CHECK(force.z() == Approx(lift).epsilon(0.05)); // a still packing holds a box of 10 spacings by some per cent

    // Sides: least squares of p over depth; ends: mean. The water stands lower by what the body displaces.
    double n = 0, sz = 0, szz = 0, sp = 0, szp = 0, top = 0, bottom = 0, tops = 0, bottoms = 0;
    for (std::size_t t = 0; t < mean.size(); ++t) {
        const Vec3d u = mesh.corner(t, 1) - mesh.corner(t, 0), v = mesh.corner(t, 2) - mesh.corner(t, 0);
        const Vec3d area = 0.5 * u.cross(v), normal = area.normalized();
        const double z = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)).z() / 3.0 + place.z();
        if (dimensions == 2 && std::abs(normal.y()) > 0.5) {
            CHECK(mean[t] == 0.0);
            continue;
        }
        if (normal.z() > 0.5)
            top += mean[t] * area.norm(), tops += area.norm();
        else if (normal.z() < -0.5)
            bottom += mean[t] * area.norm(), bottoms += area.norm();
        else
            n += 1, sz += z, szz += z * z, sp += mean[t], szp += z * mean[t];
    }
    const double slope = (n * szp - sz * sp) / (n * szz - sz * sz);
    CAPTURE(top / tops, bottom / bottoms, slope, sp / n);
    BodyState state;
    body.read(0.0, {&state, 1});
    const double surface = world.waterline({&state, 1}).value();
    CAPTURE(surface);
    // Values are means over some two spacings, which flattens the ends of a face of ten.
    CHECK(slope == Approx(-9810.0).epsilon(0.08));
    CHECK(sp / n == Approx(9810.0 * (surface - place.z())).epsilon(0.04));
    CHECK(top / tops == Approx(9810.0 * (surface - place.z() - edge / 2)).epsilon(0.04));
    CHECK(bottom / bottoms == Approx(9810.0 * (surface - place.z() + edge / 2)).epsilon(0.04));
}

TEST_CASE("a plate thinner than a spacing feels the water on either side", "[world][forces]")
{
    FluidWorld world(settings_of(2));
    add_tank(world);
    const TriangleMesh mesh = tessellate(BoxShape{Vec3d(0.2, 1.0, 0.01)}, 0.04);
    world.add_body(mesh);
    DrivenBody body(Vec3d(0.2, 0, 0.12), Vec3d::Zero());
    while (world.time() < 0.4) world.step(world.allowed_time_step(), body);
    std::array<double, 2> force{}, area{};
    for (int k = 0; k < 80; ++k) {
        world.step(world.allowed_time_step(), body);
        const std::vector<double> pressure = world.surface_pressure(0);
        for (std::size_t t = 0; t < pressure.size(); ++t) {
            const Vec3d u = mesh.corner(t, 1) - mesh.corner(t, 0), v = mesh.corner(t, 2) - mesh.corner(t, 0);
            const Vec3d part = 0.5 * u.cross(v);
            if (std::abs(part.z()) < 0.5 * part.norm()) continue;
            force[part.z() > 0.0] += pressure[t] * part.norm();
            area[part.z() > 0.0] += part.norm();
        }
    }
    BodyState state;
    body.read(0.0, {&state, 1});
    const double depth = world.waterline({&state, 1}).value() - 0.12;
    CAPTURE(force[0] / area[0], force[1] / area[1], 9810.0 * depth);
    // What presses on the plate's ends (half a spacing wide) counts as pressing on its faces (ten).
    for (std::size_t side = 0; side < 2; ++side)
        CHECK(force[side] / area[side] == Approx(9810.0 * depth).epsilon(0.15));
    CHECK(force[0] / area[0] > force[1] / area[1]);
}

TEST_CASE("pressure on a ball grows with depth and carries it", "[world][forces]")
{
    FluidWorld world(settings_of(3));
    world.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.6)}, {"+z"});
    world.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.4)});
    const double radius = 0.1;
    const TriangleMesh mesh = tessellate(SphereShape{radius}, 0.02); // half as wide as what is resolved
    world.add_body(mesh);
    DrivenBody body(Vec3d(0.2, 0.2, 0.2), Vec3d::Zero());
    while (world.time() < 0.3) world.step(world.allowed_time_step(), body);
    Vec3d force = Vec3d::Zero(), spread = Vec3d::Zero();
    double n = 0, sz = 0, szz = 0, sp = 0, szp = 0, lift = 0;
    for (int k = 0; k < 20; ++k) {
        for (int skipped = 0; skipped < 4; ++skipped) world.step(world.allowed_time_step(), body);
        const std::vector<double> pressure = world.surface_pressure(0);
        force += world.fluid_forces(0).pressure().linear;
        lift += world.fluid_forces(0).hydrostatic.linear.z();
        for (std::size_t t = 0; t < pressure.size(); ++t) {
            const Vec3d u = mesh.corner(t, 1) - mesh.corner(t, 0), v = mesh.corner(t, 2) - mesh.corner(t, 0);
            const double w = 0.5 * u.cross(v).norm();
            const double z = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)).z() / 3.0;
            spread -= 0.5 * pressure[t] * u.cross(v);
            n += w, sz += w * z, szz += w * z * z, sp += w * pressure[t], szp += w * z * pressure[t];
        }
    }
    const double slope = (n * szp - sz * sp) / (n * szz - sz * sz);
    CAPTURE(slope, sp / n, (spread - force).transpose() / lift, force.transpose() / lift);
    CHECK((spread - force).norm() < 0.01 * lift);
    CHECK(slope == Approx(-9810.0).epsilon(0.08));
    BodyState state;
    body.read(0.0, {&state, 1});
    CHECK(sp / n == Approx(9810.0 * (world.waterline({&state, 1}).value() - 0.2)).epsilon(0.05));
}

TEST_CASE("forces are read of bodies and walls that there are", "[world][forces]")
{
    FluidWorld world(settings_of(2));
    CHECK_THROWS_AS(world.fluid_forces(0), std::invalid_argument);
    CHECK_THROWS_AS(world.sample_forces(-1), std::invalid_argument);
    CHECK_THROWS_AS(world.surface_pressure(0), std::invalid_argument);
    CHECK_THROWS_AS(world.wall_wrench(0), std::invalid_argument);
    add_tank(world);
    world.add_body(tessellate(BoxShape{Vec3d(0.1, 1.0, 0.1)}, 0.02));
    CHECK_THROWS_AS(world.fluid_forces(0, Vec3d(0, std::nan(""), 0)), std::invalid_argument);
    CHECK(world.fluid_forces(0).total().linear.norm() == 0.0);
    const std::vector<double> pressure = world.surface_pressure(0);
    CHECK(std::accumulate(pressure.begin(), pressure.end(), 0.0) == 0.0);
    DrivenBody body(Vec3d(0.2, 0, 0.5), Vec3d::Zero()); // in the air
    for (int k = 0; k < 40; ++k) world.step(0.004, body);
    CHECK(world.fluid_forces(0).total().linear.norm() == 0.0);
    CHECK(world.wall_wrench(0).total().linear.isApprox(world.wall_force(0)));
    CHECK(world.wall_wrench(0).pressure.linear.z() < -0.9 * 9810.0 * 0.4 * 0.32);
    // The weight stands on the floor's middle: torque about the origin.
    CHECK(world.wall_wrench(0).pressure.angular.y() ==
          Approx(-0.2 * world.wall_wrench(0).pressure.linear.z()).epsilon(0.05));
}
