#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/box_mesh.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

#include <algorithm>
#include <functional>
#include <limits>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.02, kWidth = 0.4, kDepth = 0.3;

FluidWorldSettings plane()
{
    FluidWorldSettings s;
    s.dimensions = 2;
    s.particle_spacing = kSpacing;
    s.threads = 1;
    return s;
}

/// A tank in the plane, open above.
FluidWorld tank(const FluidWorldSettings& settings, const Vec3d& velocity = Vec3d::Zero())
{
    FluidWorld fluid(settings);
    fluid.add_box_wall({Vec3d(0, -0.1, 0), Vec3d(kWidth, 0.1, 0.6)}, {"+z"});
    fluid.add_block({Vec3d(0, -0.1, 0), Vec3d(kWidth, 0.1, kDepth)}, velocity);
    return fluid;
}

/// Moving water with a floating box in it, by the given settings, after some steps.
std::uint64_t hash_after_steps(const FluidWorldSettings& settings)
{
    FluidWorld fluid = tank(settings, Vec3d(2.5, 0, 0)); // CFL bounds the step, if max_time_step does not
    const Vec3d edges(0.1, 1.0, 0.1);
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    FreeBodies bodies({free_box(edges, 100.0, Vec3d(0.2, 0, kDepth))}, settings.gravity);
    for (int k = 0; k < 5; ++k) fluid.step(fluid.allowed_time_step(), bodies);
    return fluid.state_hash();
}

double volume(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        sum += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2))) / 6.0;
    return sum;
}

} // namespace

TEST_CASE("settings that cannot be used are refused by name", "[world]")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    const auto refused = [](auto&& set, const std::string& name) {
        FluidWorldSettings s;
        set(s);
        CHECK_THROWS_AS(FluidWorld(s), std::invalid_argument);
        CHECK_THROWS_WITH(FluidWorld(s), Catch::Matchers::Contains(name));
    };
    for (const int value : {1, 4, 0, -2}) refused([&](auto& s) { s.dimensions = value; }, "dimensions must be 2 or 3");
    for (const double value : {0.0, -1.0, nan, infinite}) {
        refused([&](auto& s) { s.particle_spacing = value; }, "particle_spacing");
        refused([&](auto& s) { s.rest_density = value; }, "rest_density");
        refused([&](auto& s) { s.max_time_step = value; }, "max_time_step");
        refused([&](auto& s) { s.cfl = value; }, "cfl");
        refused([&](auto& s) { s.pressure.tolerance = value; }, "pressure.tolerance");
        refused([&](auto& s) { s.pressure.velocity_tolerance = value; }, "pressure.velocity_tolerance");
    }
    for (const double value : {-1e-9, nan, infinite}) {
        refused([&](auto& s) { s.kinematic_viscosity = value; }, "kinematic_viscosity");
        refused([&](auto& s) { s.dissipation = value; }, "dissipation");
    }
    for (const double value : {-0.01, 1.01, nan}) {
        refused([&](auto& s) { s.packing_relief = value; }, "packing_relief must lie in [0, 1]");
    }
    refused([&](auto& s) { s.cfl = 1.01; }, "cfl");
    refused([&](auto& s) { s.gravity.x() = nan; }, "gravity");
    refused([&](auto& s) { s.gravity.z() = infinite; }, "gravity");
    for (const int value : {0, -1}) refused([&](auto& s) { s.pressure.max_iterations = value; }, "max_iterations");
    for (const int value : {-1, 100000}) refused([&](auto& s) { s.threads = value; }, "threads");
}

TEST_CASE("no setting is without effect, but the number of threads", "[world][settings]")
{
    using Change = std::function<void(FluidWorldSettings&)>;
    const std::vector<std::pair<std::string, Change>> changes = {
        {"dimensions", [](auto& s) { s.dimensions = 3; }},
        {"particle_spacing", [](auto& s) { s.particle_spacing *= 0.9; }},
        {"gravity", [](auto& s) { s.gravity.x() = 0.1; }},
        {"rest_density", [](auto& s) { s.rest_density = 800.0; }},
        {"kinematic_viscosity", [](auto& s) { s.kinematic_viscosity = 1e-4; }},
        {"dissipation", [](auto& s) { s.dissipation = 0.5; }},
        {"packing_relief", [](auto& s) { s.packing_relief = 0.5; }},
        {"max_time_step", [](auto& s) { s.max_time_step = 0.001; }},
        {"cfl", [](auto& s) { s.cfl = 0.3; }},
        {"solver", [](auto& s) { s.pressure.solver = PressureSettings::Solver::iisph; }},
        {"source", [](auto& s) { s.pressure.source = PressureSettings::Source::published; }},
        {"coupling", [](auto& s) { s.pressure.coupling = PressureSettings::Coupling::weak; }},
        {"tolerance", [](auto& s) { s.pressure.tolerance = 1e-5; }},
        {"velocity_tolerance", [](auto& s) { s.pressure.velocity_tolerance = 1e-6; }},
        {"max_iterations", [](auto& s) { s.pressure.max_iterations = 2; }},
    };
    const std::uint64_t plain = hash_after_steps(plane());
    CHECK(hash_after_steps(plane()) == plain);
    for (const auto& [name, change] : changes) {
        FluidWorldSettings s = plane();
        change(s);
        INFO(name);
        CHECK(hash_after_steps(s) != plain);
    }
    FluidWorldSettings s = plane();
    s.threads = 2;
    CHECK(hash_after_steps(s) == plain);
}

TEST_CASE("no water and no wall is added once a world is prepared", "[world]")
{
    FluidWorld fluid = tank(plane());
    NoBodies none;
    const bool by_stepping = GENERATE(false, true);
    if (by_stepping)
        fluid.step(0.001, none);
    else
        fluid.prepare(none);
    const TriangleMesh mesh = tessellate(BoxShape{Vec3d(0.1, 0.1, 0.1)}, 0.1);
    const std::vector<Vec3d> points = {Vec3d::Zero()};
    CHECK_THROWS_AS(fluid.add_block({Vec3d(0, 0, 0), Vec3d(1, 1, 1)}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_fluid_mesh(mesh), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_particles(points), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_wall(mesh), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(1, 1, 1)}), std::invalid_argument);
    CHECK(fluid.add_body(mesh) == 0); // bodies come and go
}

TEST_CASE("a first step or prepare that is refused changes nothing", "[world]")
{
    const Vec3d edges(0.1, 1.0, 0.1);
    FluidWorld refused = tank(plane()), other = tank(plane());
    for (FluidWorld* fluid : {&refused, &other}) fluid->add_body(tessellate(BoxShape{edges}, kSpacing));
    NoBodies none;
    if (GENERATE(false, true))
        CHECK_THROWS_AS(refused.step(0.001, none), std::invalid_argument);
    else
        CHECK_THROWS_AS(refused.prepare(none), std::invalid_argument);
    refused.remove_body(0);
    refused.add_body(tessellate(BoxShape{edges}, kSpacing));
    other.remove_body(0);
    other.add_body(tessellate(BoxShape{edges}, kSpacing));
    const FreeBody box = free_box(edges, 500.0, Vec3d(0.2, 0, kDepth));
    FreeBodies first({box, box}, plane().gravity), second({box, box}, plane().gravity);
    refused.step(0.001, first);
    other.step(0.001, second);
    CHECK(refused.fluid().size() > 200);
    CHECK(refused.state_hash() == other.state_hash());
}

TEST_CASE("a body whose state is not finite is refused by its number before the water feels it", "[world]")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    const Vec3d edges(0.1, 1.0, 0.1);
    FluidWorld fluid = tank(plane());
    for (int k = 0; k < 2; ++k) fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    const FreeBody left = free_box(edges, 500.0, Vec3d(0.1, 0, kDepth)),
                   right = free_box(edges, 500.0, Vec3d(0.3, 0, kDepth));
    FreeBodies bodies({left, right}, plane().gravity);
    const bool has_stepped = GENERATE(false, true);
    if (has_stepped) fluid.step(0.001, bodies);
    const std::uint64_t before = fluid.state_hash();
    const auto refused = [&](auto&& spoil, const std::string& what) {
        const FreeBody sound = bodies.bodies[1];
        spoil(bodies.bodies[1]);
        CHECK_THROWS_AS(fluid.step(0.001, bodies), std::invalid_argument);
        CHECK_THROWS_WITH(fluid.step(0.001, bodies),
                          Catch::Matchers::Contains("body 1 must have") && Catch::Matchers::Contains(what));
        bodies.bodies[1] = sound;
    };
    refused([&](FreeBody& b) { b.pose.position.z() = nan; }, "position");
    refused([&](FreeBody& b) { b.pose.position.x() = infinite; }, "position");
    refused([&](FreeBody& b) { b.pose.orientation = Quatd(nan, 0, 0, 0); }, ""); // its angular velocity is none either
    refused([&](FreeBody& b) { b.pose.orientation = Quatd(2, 0, 0, 0); }, "orientation of norm 1, given 2");
    refused([&](FreeBody& b) { b.momentum.y() = nan; }, "velocity");
    refused([&](FreeBody& b) { b.angular_momentum.y() = infinite; }, "angular velocity");
    CHECK(fluid.state_hash() == before);
    fluid.step(0.001, bodies);
    for (const Vec4& p : fluid.fluid().position) REQUIRE(p.allFinite());
    CHECK(fluid.fluid().size() > 200);
    fluid.remove_body(1); // nobody is asked about it any more
    bodies.bodies[1].pose.position.x() = nan;
    CHECK_NOTHROW(fluid.step(0.001, bodies));
}

TEST_CASE("what cannot be added or read is refused", "[world]")
{
    FluidWorld fluid(plane());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Vec3d> nowhere = {Vec3d(0, nan, 0)};
    CHECK_THROWS_AS(fluid.add_block({Vec3d(1, 0, 0), Vec3d(0, 1, 1)}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_block({Vec3d(0, 0, 0), Vec3d(1, 1, 1)}, Vec3d(nan, 0, 0)), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_particles(nowhere), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_particles(std::vector<Vec3d>(1, Vec3d::Zero()), Vec3d(0, 0, nan)), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_wall({}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_body({}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_fluid_mesh({}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(1, 1, 1)}, {"up"}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(0, 1, 1)}), std::invalid_argument);
    CHECK_THROWS_AS(fluid.wall_mesh(0), std::invalid_argument);
    CHECK_THROWS_AS(fluid.wall_force(-1), std::invalid_argument);
    CHECK_THROWS_AS(fluid.fluid_wrench(0), std::invalid_argument);
    NoBodies none;
    for (const double dt : {0.0, -0.1, nan, std::numeric_limits<double>::infinity()}) {
        CHECK_THROWS_AS(fluid.step(dt, none), std::invalid_argument);
    }
    fluid.add_body(tessellate(BoxShape{Vec3d(0.1, 1, 0.1)}, 0.1));
    CHECK_THROWS_AS(fluid.step(0.001, none), std::invalid_argument); // the port has no such body
}

TEST_CASE("meshes that would be read beyond their ends or inside out are refused", "[world]")
{
    FluidWorld fluid(plane());
    const TriangleMesh sound = tessellate(BoxShape{Vec3d(0.1, 1, 0.1)}, 1.0);
    fluid.add_body(sound);
    const auto refused = [&](const TriangleMesh& mesh, const std::string& why) {
        const auto contains = Catch::Matchers::Contains(why);
        CHECK_THROWS_AS(fluid.add_body(mesh), std::invalid_argument);
        CHECK_THROWS_WITH(fluid.add_body(mesh), contains);
        CHECK_THROWS_WITH(fluid.reshape_body(0, mesh), contains);
        CHECK_THROWS_WITH(fluid.add_fluid_mesh(mesh), contains);
    };
    for (const int index : {-1, 8, 99999999}) {
        TriangleMesh mesh = sound;
        mesh.triangles[3][1] = index;
        refused(mesh, "0 to 7, triangle 3 names vertex " + std::to_string(index));
        CHECK_THROWS_AS(fluid.add_wall(mesh), std::invalid_argument);
    }
    for (const double number : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        TriangleMesh mesh = sound;
        mesh.vertices[2].y() = number;
        refused(mesh, "finite vertices [m], vertex 2");
        CHECK_THROWS_AS(fluid.add_wall(mesh), std::invalid_argument);
    }
    refused(flipped(sound), "face outward");
    CHECK(fluid.add_wall(flipped(sound)) == 0); // a wall may have its water on either side
    CHECK(fluid.body_count() == 1);
    CHECK(fluid.wall_count() == 1);
}

TEST_CASE("a world without water, walls or bodies steps", "[world]")
{
    FluidWorld fluid(plane());
    NoBodies none;
    const StepReport report = fluid.step(0.001, none);
    CHECK(report.converged);
    CHECK(report.max_speed == 0.0);
    CHECK(fluid.time() == 0.001);
    CHECK(fluid.pressure_at(Vec3d::Zero()) == 0.0);
    CHECK_FALSE(fluid.level_at(0.0, 0.0));
    CHECK_FALSE(fluid.waterline({}));
}

TEST_CASE("single particles stay where the caller wants them, however close", "[world]")
{
    // The relaxation at the start moves them too, though add_particles promises otherwise.
    FluidWorld fluid(plane());
    std::vector<Vec3d> points; // four times as dense as water
    for (int k = 0; k < 25; ++k) points.emplace_back(0.5 * kSpacing * (k % 5), 0.0, 0.5 * kSpacing * (k / 5));
    fluid.add_particles(points);
    NoBodies none;
    fluid.prepare(none);
    REQUIRE(fluid.fluid().size() == 25);
    double moved = 0.0;
    for (std::size_t i = 0; i < 25; ++i) {
        const Vec3d at = fluid.fluid().position[i].head<3>().cast<double>();
        moved = std::max(moved, (at - points[fluid.fluid().id[i]]).norm());
    }
    CHECK(moved < 1e-6); // rounded to float
}

TEST_CASE("a still tank has the pressure, level and weight of its water", "[world]")
{
    FluidWorld fluid = tank(plane());
    NoBodies none;
    const auto step_until = [&](double time, auto&& watch) {
        while (fluid.time() < time) {
            const double dt = std::min(fluid.allowed_time_step(), time - fluid.time() + 1e-12);
            watch(dt, fluid.step(dt, none));
        }
    };
    step_until(0.6, [](double, const StepReport&) {});
    Vec3d impulse = Vec3d::Zero(), worst = Vec3d::Zero();
    double seconds = 0.0, pressure = 0.0, level = 0.0, line = 0.0, middle = 0.0;
    const Vec3d bottom(0.5 * kWidth, 0, 0.2 * kDepth);
    Vec3d before = Vec3d::Zero();
    bool first = true;
    step_until(1.1, [&](double dt, const StepReport& report) {
        impulse += dt * fluid.wall_force(0);
        seconds += dt;
        pressure += dt * fluid.pressure_at(bottom);
        middle += dt * fluid.pressure_at(Vec3d(0.5 * kWidth, 0, 0.5 * kDepth));
        level += dt * fluid.level_at(0.5 * kWidth, 0.0).value();
        line += dt * fluid.waterline({}).value();
        if (!first) {
            const Vec3d rest = report.fluid_momentum - before - report.gravity_impulse + report.wall_impulse;
            worst = worst.cwiseMax(rest.cwiseAbs());
        }
        before = report.fluid_momentum;
        first = false;
    });
    const double weight = 1000.0 * 9.81 * kWidth * kDepth;
    const Vec3d force = impulse / seconds;
    CAPTURE(force.transpose() / weight, pressure / seconds, middle / seconds, level / seconds, line / seconds);
    CHECK(worst.norm() < 1e-5 * weight * 0.004);       // what walls get in a step is what the fluid gives
    CHECK(-force.z() == Approx(weight).epsilon(0.01)); // what is left of the swell, over half a second
    CHECK(std::abs(force.x()) < 0.01 * weight);
    // Half a spacing is the place of the surface's uppermost layer; pressures are of 12 and 7.5 layers below it.
    CHECK(level / seconds == Approx(kDepth).margin(0.5 * kSpacing));
    CHECK(line / seconds == Approx(kDepth).margin(0.5 * kSpacing));
    for (const double x : {0.0, 0.25 * kSpacing, kSpacing, kWidth}) // at the walls it is no lower
        CHECK(fluid.level_at(x, 0.0).value() == Approx(kDepth).margin(0.5 * kSpacing));
    CHECK(pressure / seconds == Approx(1000.0 * 9.81 * 0.8 * kDepth).epsilon(0.05));
    CHECK(middle / seconds == Approx(1000.0 * 9.81 * 0.5 * kDepth).epsilon(0.05));
    CHECK(fluid.pressure_at(Vec3d(0.5 * kWidth, 0, 0.5)) == 0.0); // above the water
    CHECK_FALSE(fluid.level_at(2.0 * kWidth, 0.0));
}

TEST_CASE("fluid that lies in a body is cut and noted", "[world]")
{
    FluidWorld fluid = tank(plane()), clear = tank(plane());
    const Vec3d edges(0.1, 1.0, 0.1);
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    FreeBodies bodies({free_box(edges, 500.0, Vec3d(0.2, 0, 0.15))});
    NoBodies none;
    fluid.prepare(bodies);
    clear.prepare(none);
    CHECK(clear.notes().empty());
    CHECK(clear.fluid().size() == 20 * 15);
    CHECK(fluid.fluid().size() == 20 * 15 - 25); // 5 x 5 particles
    REQUIRE(fluid.notes().size() == 1);
    CHECK(fluid.notes()[0] == "25 of 300 fluid particles lay inside walls or bodies and were cut away");
}

TEST_CASE("in two dimensions a body feels the water when rounding has turned it out of the plane", "[world]")
{
    FluidWorldSettings settings;
    settings.dimensions = 2;
    settings.gravity = Vec3d(0, 0, -9.81);
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(0.6, 0, 0.6)}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(0.6, 0, 0.4)});
    world.add_body(tessellate(DiscShape{0.08}, settings.particle_spacing));
    FreeBody disc;
    disc.mass = 10.0;
    disc.pose = {Vec3d(0.3, 0, 0.2), Quatd(Eigen::AngleAxisd(1e-16, Vec3d(1, 1, -1).normalized()))};
    FreeBodies bodies({disc}, settings.gravity);
    for (int step = 0; step < 30; ++step) world.step(0.001, bodies);
    REQUIRE(world.boundary().size() > 50);
    for (const Vec4& position : world.boundary().position) CHECK(position.y() == 0.0f);
    CHECK(bodies.bodies[0].momentum.z() > 0.0); // it is half as heavy as the water in its place
}

TEST_CASE("in two dimensions water stays in the plane, whatever rounding does to a body's velocity", "[world]")
{
    FluidWorld fluid = tank(plane());
    const Vec3d edges(0.1, 1.0, 0.08);
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    FreeBody box = free_box(edges, 500.0, Vec3d(0.2, 0, 0.25));
    box.pose.orientation = Quatd(Eigen::AngleAxisd(0.3, Vec3d(1e-16, 1.0, -1e-16).normalized()));
    box.momentum.y() = 1e-12;
    box.angular_momentum = Vec3d(1e-12, 0, -1e-12);
    FreeBodies bodies({box}, fluid.settings().gravity);
    while (fluid.time() < 0.3) fluid.step(fluid.allowed_time_step(), bodies);
    const auto out_of_plane = [](const std::vector<Vec4>& vectors) {
        return std::count_if(vectors.begin(), vectors.end(), [](const Vec4& v) { return v[1] != 0; });
    };
    CHECK(out_of_plane(fluid.fluid().position) == 0);
    CHECK(out_of_plane(fluid.fluid().velocity) == 0);
    CHECK(std::abs(fluid.fluid_wrench(0).linear.y()) < 1e-9);
}

TEST_CASE("notes call walls and bodies by their names", "[world]")
{
    FluidWorld fluid = tank(plane());
    const Vec3d edges(0.01, 1.0, 0.01); // a rod
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    fluid.name_body(fluid.add_body(tessellate(BoxShape{edges}, kSpacing)), "the rod");
    CHECK_THROWS_AS(fluid.name_body(2, "nobody"), std::invalid_argument);
    CHECK_THROWS_AS(fluid.name_wall(1, "nothing"), std::invalid_argument);
    fluid.name_wall(0, "the tank");
    FreeBodies bodies({free_box(edges, 500.0, Vec3d(0.2, 0, 0.4)), free_box(edges, 500.0, Vec3d(0.2, 0, 0.5))});
    fluid.prepare(bodies);
    REQUIRE(fluid.notes().size() == 2);
    CHECK(fluid.notes()[0].rfind("body 0 is thinner", 0) == 0);
    CHECK(fluid.notes()[1].rfind("the rod is thinner", 0) == 0);
}

TEST_CASE("a tank crowded with bodies has a water line where it is open", "[world]")
{
    // Two boxes that leave gaps of three spacings; circles around them cover the whole tank.
    FluidWorld fluid = tank(plane());
    const Vec3d edges(0.11, 1.0, 0.3);
    for (int k = 0; k < 2; ++k) fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    FreeBodies bodies({free_box(edges, 500.0, Vec3d(0.115, 0, 0.3)), free_box(edges, 500.0, Vec3d(0.285, 0, 0.3))});
    fluid.prepare(bodies);
    std::vector<BodyState> states(2);
    bodies.read(0.0, states);
    REQUIRE(fluid.waterline(states).has_value());
    CHECK(*fluid.waterline(states) == Approx(kDepth).margin(0.5 * kSpacing));
}

TEST_CASE("water under a lid has no water line", "[world]")
{
    FluidWorld fluid = tank(plane());
    const Vec3d edges(kWidth, 1.0, 0.1);
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    FreeBodies bodies({free_box(edges, 500.0, Vec3d(0.5 * kWidth, 0, kDepth + 0.5 * edges.z()))});
    fluid.prepare(bodies);
    std::vector<BodyState> states(1);
    bodies.read(0.0, states);
    CHECK_FALSE(fluid.waterline(states));
}

TEST_CASE("the side of a wall is found from the fluid", "[world]")
{
    FluidWorldSettings settings;
    settings.particle_spacing = 0.05;
    settings.threads = 1;
    FluidWorld fluid(settings);
    NoBodies none;
    const Aabb room{Vec3d(0, 0, 0), Vec3d(0.6, 0.5, 0.4)};
    fluid.add_block({room.min, Vec3d(0.6, 0.5, 0.2)});
    const std::size_t all = 12 * 10 * 4;

    SECTION("a container stays as it is and cuts nothing")
    {
        const int wall = fluid.add_wall(box_mesh(room));
        fluid.prepare(none);
        CHECK(volume(fluid.wall_mesh(wall)) == Approx(room.size().prod()));
        CHECK(fluid.fluid().size() == all);
        for (int k = 0; k < 25; ++k) fluid.step(0.004, none);
        CHECK(fluid.wall_force(wall).z() < 0.0); // it holds the water
    }
    SECTION("a container inside out is turned")
    {
        const int wall = fluid.add_wall(flipped(box_mesh(room)));
        fluid.prepare(none);
        CHECK(volume(fluid.wall_mesh(wall)) == Approx(room.size().prod()));
        CHECK(fluid.fluid().size() == all);
    }
    SECTION("a container that has not half of the water inside cuts it, if nothing else holds water")
    {
        const int wall = fluid.add_wall(box_mesh({Vec3d(-0.1, 0, 0), Vec3d(0.24, 0.5, 0.4)}));
        fluid.prepare(none);
        CHECK(fluid.fluid().size() < all / 2);
        CHECK(fluid.notes()[0].find("is taken for the container of the water") != std::string::npos);
        for (int k = 0; k < 25; ++k) fluid.step(0.004, none);
        CHECK(fluid.wall_force(wall).z() < 0.0);
    }
    SECTION("in a container it is an obstacle")
    {
        fluid.add_wall(box_mesh({Vec3d(-0.1, 0, 0), Vec3d(0.24, 0.5, 0.4)}));
        fluid.add_box_wall({Vec3d(-0.1, 0, 0), Vec3d(0.6, 0.5, 0.4)}, {"+z"});
        fluid.prepare(none);
        CHECK(fluid.fluid().size() > all / 2);
    }
    SECTION("an obstacle cuts the fluid")
    {
        fluid.add_box_wall(room);
        const Aabb block{Vec3d(0.2, 0.2, 0.0), Vec3d(0.4, 0.4, 0.2)};
        const int wall = fluid.add_wall(box_mesh(block));
        fluid.prepare(none);
        CHECK(volume(fluid.wall_mesh(wall)) == Approx(block.size().prod()));
        CHECK(fluid.fluid().size() == all - 4 * 4 * 4);
        CHECK(fluid.notes().size() == 1);
    }
    SECTION("a sheet has water on both sides")
    {
        fluid.add_box_wall(room);
        TriangleMesh sheet;
        sheet.vertices = {Vec3d(0.3, 0, 0), Vec3d(0.3, 0.5, 0), Vec3d(0.3, 0.5, 0.3), Vec3d(0.3, 0, 0.3)};
        sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
        const int wall = fluid.add_wall(sheet);
        fluid.prepare(none);
        CHECK(fluid.fluid().size() == all);
        const auto& owner = fluid.boundary().owner;
        CHECK(std::count(owner.begin(), owner.end(), wall) > 30);
        const auto right = [&] {
            std::size_t n = 0;
            for (const Vec4& p : fluid.fluid().position) n += p.x() > Scalar(0.3) ? 1 : 0;
            return n;
        };
        CHECK(right() == all / 2);
        for (int k = 0; k < 25; ++k) fluid.step(0.004, none);
        CHECK(right() == all / 2);
    }
}

TEST_CASE("the allowed step follows speed, viscosity and the given bound", "[world]")
{
    FluidWorldSettings s = plane();
    s.gravity = Vec3d::Zero();
    CHECK(FluidWorld(s).allowed_time_step() == s.max_time_step);
    s.kinematic_viscosity = 0.1;
    CHECK(FluidWorld(s).allowed_time_step() == Approx(0.125 * 4.0 * kSpacing * kSpacing / 0.4));
    s.kinematic_viscosity = 0.0;
    FluidWorld fluid(s);
    fluid.add_particles(std::vector<Vec3d>(1, Vec3d::Zero()), Vec3d(10, 0, 0));
    NoBodies none;
    fluid.prepare(none);
    CHECK(fluid.allowed_time_step() == Approx(s.cfl * kSpacing / 10.0));

    FluidWorld below = tank(s); // a body that is fast from the start counts in the first step
    below.add_body(tessellate(DiscShape{0.05}, kSpacing));
    FreeBody disc;
    disc.pose.position = Vec3d(0.2, 0, 0.5);
    disc.momentum = Vec3d(0, 0, -20.0);
    FreeBodies bodies({disc});
    below.prepare(bodies);
    CHECK(below.allowed_time_step() == Approx(s.cfl * kSpacing / 20.0));
}

TEST_CASE("particles under a heavy plate on the floor do not carry it", "[world]")
{
    const FluidWorldSettings s = plane();
    FluidWorld fluid = tank(s);
    const Vec3d edges(0.2, 1.0, 0.04);
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    // It stands a fifth of a spacing above the floor, with a particle in the gap.
    const FreeBody plate = free_box(edges, 20000.0, Vec3d(0.2, 0, 0.024));
    fluid.add_particles(std::vector<Vec3d>(1, Vec3d(0.2, 0, 0.002)), Vec3d::Zero());
    FreeBodies bodies({plate}, s.gravity);
    double highest = 0.0;
    for (int k = 0; k < 10; ++k) {
        StepReport report = fluid.step(0.0005, bodies);
        CHECK(report.converged);
        for (const Scalar pressure : fluid.fluid().pressure) highest = std::max(highest, static_cast<double>(pressure));
    }
    CHECK(highest < 2e4); // of 7.5e3 in the mean under the plate; 3e3 at the floor without it
    CHECK(bodies.bodies[0].pose.position.z() < 0.024);
}

TEST_CASE("a sheet of water that falls to the floor keeps its density, in the corners, too", "[world]")
{
    FluidWorldSettings s = plane();
    s.dimensions = 3;
    s.particle_spacing = 0.01;
    FluidWorld fluid(s);
    fluid.add_box_wall({Vec3d::Zero(), Vec3d(0.16, 0.16, 0.2)}, {"+z"});
    // Two layers of it: nearly all of the water is shifted when it strikes the floor, as if it were enclosed.
    fluid.add_block({Vec3d(0.02, 0.02, 0.03), Vec3d(0.14, 0.14, 0.05)});
    NoBodies none;
    double mean = 0.0, largest = 0.0;
    while (fluid.time() < 0.6) {
        const StepReport report = fluid.step(fluid.allowed_time_step(), none);
        mean = std::max(mean, report.compression_mean);
        largest = std::max(largest, report.compression_max);
        CHECK(report.converged);
    }
    CHECK(mean < 0.05);    // in the step of the impact
    CHECK(largest < 0.25); // 1 where the corners keep three particles in one place
}

TEST_CASE("a closed tank that is filled to the last particle holds together", "[world]")
{
    const Vec3d gravity = GENERATE(Vec3d(0, 0, -9.81), Vec3d(0, 0, 0));
    const KernelKind kernel = GENERATE(KernelKind::quintic, KernelKind::cubic);
    FluidWorldSettings s = plane();
    s.gravity = gravity;
    s.kernel = kernel;
    FluidWorld fluid(s);
    const Aabb inside{Vec3d(0, -0.1, 0), Vec3d(1.0, 0.1, 0.6)};
    fluid.add_box_wall(inside, {});
    fluid.add_block(inside);
    NoBodies none;
    double compression = 0.0, fastest = 0.0;
    while (fluid.time() < 0.3) {
        const StepReport report = fluid.step(fluid.allowed_time_step(), none);
        compression = std::max(compression, report.compression_mean);
        fastest = std::max(fastest, report.max_speed);
    }
    CHECK(fluid.fluid().size() >= 1500 - 15);
    CHECK(compression < 0.002);
    CHECK(fastest < 0.5);
    REQUIRE(fluid.notes().size() == 1);
    CHECK(fluid.notes()[0].find("of 1500 fluid particles found no room") != std::string::npos);
}

TEST_CASE("water that falls out over an open side is removed and booked, and holds no step up", "[world]")
{
    FluidWorldSettings s = plane();
    FluidWorld fluid(s);
    fluid.add_box_wall({Vec3d(0, -0.1, 0), Vec3d(0.2, 0.1, 0.2)}, {"+x", "+z"});
    fluid.add_block({Vec3d(0, -0.1, 0), Vec3d(0.2, 0.1, 0.2)});
    NoBodies none;
    fluid.prepare(none);
    const std::size_t before = fluid.fluid().size();
    int fallen = 0;
    while (fluid.time() < 1.5) {
        const StepReport report = fluid.step(fluid.allowed_time_step(), none);
        CHECK(report.removed_particles == report.fallen_particles);
        fallen += report.fallen_particles;
    }
    CHECK(fallen > 30);
    CHECK(fluid.fluid().size() == before - static_cast<std::size_t>(fallen));
    CHECK(fluid.ledger().removed.volume == Approx(fallen * kSpacing * kSpacing));
    CHECK(std::abs(fluid.ledger().errors().volume) < 1e-9);
    // From 0.2 m down to 0.2 m below the floor, and a step further.
    for (const Vec4& p : fluid.fluid().position) CHECK(p.z() > Scalar(-0.25));
    CHECK(fluid.allowed_time_step() > s.cfl * kSpacing / 4.0);
}

TEST_CASE("bodies of one shape have the same samples, also those that come later or change", "[world]")
{
    FluidWorldSettings settings;
    settings.particle_spacing = kSpacing;
    settings.threads = 1;
    FluidWorld fluid(settings);
    fluid.add_box_wall({Vec3d::Zero(), Vec3d(0.6, 0.3, 0.6)}, {"+z"});
    fluid.add_block({Vec3d::Zero(), Vec3d(0.6, 0.3, 0.1)});
    const TriangleMesh ball = tessellate(SphereShape{0.05}, kSpacing), box = tessellate(BoxShape{{0.1, 0.1, 0.1}}, 0.1);
    std::vector<Pose> poses;
    const auto add = [&](const TriangleMesh& mesh) {
        const double turn = 0.3 * static_cast<double>(poses.size());
        poses.push_back({Vec3d(0.1 + 0.15 * static_cast<double>(poses.size()), 0.15, 0.3),
                         Quatd(Eigen::AngleAxisd(turn, Vec3d::UnitX()))});
        return fluid.add_body(mesh);
    };
    const auto step = [&] {
        HeldBodies bodies(poses);
        fluid.step(1e-3, bodies);
    };
    /// In the body's frame, and where they are.
    const auto samples_of = [&](int body, std::vector<Scalar>& volumes) {
        std::vector<Vec3d> positions;
        const BoundaryState& boundary = fluid.boundary();
        for (std::size_t b = 0; b < boundary.size(); ++b) {
            if (boundary.owner[b] != 1 + body) continue; // owner 0: the tank
            positions.push_back(boundary.position_body[b]);
            volumes.push_back(boundary.volume[b]);
            const Vec3d world = poses[static_cast<std::size_t>(body)].to_world(boundary.position_body[b]);
            CHECK((boundary.position[b].head<3>().cast<double>() - world).norm() < 1e-6);
        }
        return positions;
    };
    const auto have_same = [&](int a, int b) {
        std::vector<Scalar> volumes_a, volumes_b;
        const std::vector<Vec3d> of_a = samples_of(a, volumes_a), of_b = samples_of(b, volumes_b);
        return !of_a.empty() && of_a == of_b && volumes_a == volumes_b;
    };
    const int first = add(ball), second = add(ball), other = add(box);
    step();
    CHECK(have_same(first, second));
    CHECK_FALSE(have_same(first, other));
    const int late = add(box);
    fluid.reshape_body(second, box);
    step();
    CHECK(have_same(late, other));
    CHECK(have_same(second, other));
    CHECK_FALSE(have_same(first, second));
    fluid.reshape_body(other, ball); // whose twin is another now
    step();
    CHECK(have_same(other, first));
    CHECK(have_same(late, second));
}
