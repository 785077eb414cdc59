#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace flotsam;
using namespace flotsam::test;

namespace {

using Start = FluidWorldSettings::Start;

constexpr double kSpacing = 0.02, kWidth = 0.4, kDepth = 0.3, kGravity = 9.81;

FluidWorldSettings settings_for(Start start, int dimensions = 2)
{
    FluidWorldSettings s;
    s.dimensions = dimensions;
    s.particle_spacing = kSpacing;
    s.threads = 1;
    s.start = start;
    return s;
}

/// A tank that is open above; in 3-D a third as deep as it is wide to both sides.
FluidWorld tank(const FluidWorldSettings& settings)
{
    const double y = settings.dimensions == 2 ? 0.1 : 0.2, depth = settings.dimensions == 2 ? kDepth : 0.2;
    FluidWorld fluid(settings);
    fluid.add_box_wall({Vec3d(0, -y, 0), Vec3d(kWidth, y, 0.6)}, {"+z"});
    fluid.add_block({Vec3d(0, -y, 0), Vec3d(kWidth, y, depth)});
    return fluid;
}

double mean_speed(const FluidState& fluid)
{
    double sum = 0.0;
    for (const Vec4& v : fluid.velocity) sum += static_cast<double>(v.head<3>().norm());
    return sum / static_cast<double>(fluid.size());
}

/// How the water of a tank behaves from its first step on.
struct Beginning {
    double speed = 0.0;       ///< mean over particles and time [m/s]
    double floor_error = 0.0; ///< largest, of the force on the floor over the water's weight
    double level = 0.0;       ///< at the start [m]
    double pressure = 0.0;    ///< in the middle of the water, before the first step [Pa]
};

Beginning begin(const FluidWorldSettings& settings, double seconds)
{
    FluidWorld fluid = tank(settings);
    NoBodies none;
    fluid.prepare(none);
    Beginning out;
    out.level = fluid.level_at(0.5 * kWidth, 0.0).value();
    out.pressure = fluid.pressure_at(Vec3d(0.5 * kWidth, 0, 0.5 * out.level));
    const double weight =
        1000.0 * kGravity * std::pow(kSpacing, settings.dimensions) * static_cast<double>(fluid.fluid().size());
    while (fluid.time() < seconds) {
        const double dt = fluid.allowed_time_step();
        fluid.step(dt, none);
        out.speed += dt / seconds * mean_speed(fluid.fluid());
        out.floor_error = std::max(out.floor_error, std::abs(-fluid.wall_force(0).z() / weight - 1.0));
    }
    return out;
}

/// Of the water that was added last, at the start; by the number of particles.
std::vector<Vec3d> last_added(FluidWorld& fluid, std::size_t count)
{
    NoBodies none;
    fluid.prepare(none);
    std::vector<Vec3d> places(fluid.fluid().size());
    for (std::size_t i = 0; i < places.size(); ++i)
        places[fluid.fluid().id[i]] = fluid.fluid().position[i].head<3>().cast<double>();
    return {places.end() - static_cast<std::ptrdiff_t>(count), places.end()};
}

bool has_note(const FluidWorld& fluid, const std::string& part)
{
    return std::any_of(fluid.notes().begin(), fluid.notes().end(),
                       [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

} // namespace

TEST_CASE("water that starts at rest is still, level and heavy from the first step on", "[world][settle]")
{
    const int dimensions = GENERATE(2, 3);
    const double depth = dimensions == 2 ? kDepth : 0.2;
    const double fast = std::sqrt(kGravity * depth);
    const Beginning given = begin(settings_for(Start::as_given, dimensions), 0.1);
    const Beginning rest = begin(settings_for(Start::at_rest, dimensions), 0.1);
    CAPTURE(dimensions, given.speed / fast, rest.speed / fast, given.floor_error, rest.floor_error, rest.level / depth);
    REQUIRE(given.speed > 0.003 * fast); // the lattice falls into place
    REQUIRE(given.floor_error > 0.05);
    CHECK(rest.speed < 0.2 * given.speed); // a sixteenth (2-D), a thirtieth; what is left creeps
    CHECK(rest.speed < 0.002 * fast);
    CHECK(rest.floor_error < 0.02); // the packing creeps in jerks
    CHECK(std::abs(rest.level - depth) < 0.25 * kSpacing);
    CHECK(given.pressure == 0.0);
    CHECK(rest.pressure == Approx(1000.0 * kGravity * 0.5 * depth).epsilon(0.03)); // as pressures tremble
}

TEST_CASE("whoever waits for water to come to rest is told after each round", "[world][settle]")
{
    FluidWorld watched = tank(settings_for(Start::at_rest)), alone = tank(settings_for(Start::at_rest));
    NoBodies none;
    std::vector<SettleProgress> told;
    watched.prepare(none, [&](const SettleProgress& progress) { told.push_back(progress); });
    alone.prepare(none);
    CHECK(watched.state_hash() == alone.state_hash());
    REQUIRE(told.size() > 20);
    for (std::size_t k = 0; k < told.size(); ++k) {
        CHECK(told[k].rounds == static_cast<int>(k) + 1);
        CHECK(told[k].is_last == (k + 1 == told.size()));
    }
    CHECK(told.back().rounds < told.back().most_rounds); // it came to rest
    CHECK(told.back().speed < told.back().still_speed);
    CHECK(told.front().speed > told.front().still_speed);

    FluidWorld given = tank(settings_for(Start::as_given));
    given.prepare(none, [](const SettleProgress&) { FAIL("nothing is brought to rest"); });
}

TEST_CASE("water whose way to rest is broken off goes on with it", "[world][settle]")
{
    FluidWorld broken_off = tank(settings_for(Start::at_rest)), alone = tank(settings_for(Start::at_rest));
    NoBodies none;
    const auto break_off = [](const SettleProgress& progress) {
        if (progress.rounds == 5) throw std::runtime_error("not now");
    };
    CHECK_THROWS_WITH(broken_off.prepare(none, break_off), "not now");
    CHECK_THROWS_AS(broken_off.add_block({Vec3d(0, 0, 0), Vec3d(1, 1, 1)}), std::invalid_argument);
    int rounds = 0;
    broken_off.prepare(none, [&](const SettleProgress&) { ++rounds; });
    alone.prepare(none);
    CHECK(rounds > 20);
    CHECK(mean_speed(broken_off.fluid()) == 0.0);
    CHECK(broken_off.state_hash() == alone.state_hash());
}

TEST_CASE("bodies stand still while water comes to rest around them", "[world][settle]")
{
    const auto settings = settings_for(Start::at_rest);
    FluidWorld fluid = tank(settings);
    const Vec3d edges(0.12, 1.0, 0.12), middle(0.2, 0, kDepth);
    fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
    FreeBodies bodies({free_box(edges, 500.0, middle)}, settings.gravity);
    bodies.bodies[0].momentum = Vec3d(0, 0, -30);
    fluid.prepare(bodies);
    CHECK(bodies.bodies[0].pose.position == middle);
    CHECK(bodies.bodies[0].momentum == Vec3d(0, 0, -30));
    CHECK(fluid.time() == 0.0);
    CHECK(fluid.ledger().start.momentum == Vec3d::Zero());
    CHECK(mean_speed(fluid.fluid()) == 0.0);
    for (const Vec4& p : fluid.fluid().position) {
        const Vec3d from = (p.head<3>().cast<double>() - middle).cwiseAbs();
        REQUIRE((from.x() > 0.059 || from.z() > 0.059)); // none came in
    }
    // From the first step on the body is what it is again: it falls on.
    bodies.bodies[0].momentum = Vec3d::Zero();
    fluid.step(fluid.allowed_time_step(), bodies);
    const double weight = bodies.bodies[0].mass * kGravity;
    CHECK(fluid.fluid_wrench(0).linear.z() == Approx(weight).epsilon(0.05)); // 1 %: a body six spacings wide
}

TEST_CASE("water that nothing carries waits in the air", "[world][settle]")
{
    const auto drop = [](Start start) {
        FluidWorld fluid = tank(settings_for(start));
        fluid.add_block({Vec3d(0.1, -0.1, 0.45), Vec3d(0.2, 0.1, 0.55)});
        return last_added(fluid, 25);
    };
    const std::vector<Vec3d> given = drop(Start::as_given), rest = drop(Start::at_rest);
    for (std::size_t k = 0; k < given.size(); ++k) CHECK((rest[k] - given[k]).norm() < 0.1 * kSpacing);

    const auto single = [](Start start) { // and particles by themselves do wherever they are
        FluidWorld fluid = tank(settings_for(start));
        const std::vector<Vec3d> places{Vec3d(0.2, 0, kDepth + 0.01)};
        fluid.add_particles(places);
        return last_added(fluid, 1).front();
    };
    CHECK(single(Start::at_rest) == single(Start::as_given));
}

TEST_CASE("water without gravity or walls has nothing to come to rest on", "[world][settle]")
{
    const auto prepared = [](Start start, const Vec3d& gravity, bool walled) {
        FluidWorldSettings s = settings_for(start);
        s.gravity = gravity;
        FluidWorld fluid = walled ? tank(s) : FluidWorld(s);
        if (!walled) fluid.add_block({Vec3d(0, -0.1, 0), Vec3d(kWidth, 0.1, kDepth)});
        NoBodies none;
        fluid.prepare(none);
        return fluid.state_hash();
    };
    const Vec3d down(0, 0, -kGravity);
    CHECK(prepared(Start::at_rest, Vec3d::Zero(), true) == prepared(Start::as_given, Vec3d::Zero(), true));
    CHECK(prepared(Start::at_rest, down, false) == prepared(Start::as_given, down, false));
    CHECK(prepared(Start::at_rest, down, true) != prepared(Start::as_given, down, true));
}

TEST_CASE("water that cannot rest as it is given says so", "[world][settle]")
{
    NoBodies none;
    FluidWorld still = tank(settings_for(Start::at_rest));
    still.prepare(none);
    CHECK_FALSE(has_note(still, "does not rest"));

    FluidWorld dam(settings_for(Start::at_rest));
    dam.add_box_wall({Vec3d(0, -0.1, 0), Vec3d(4.0, 0.1, 0.6)}, {"+z"});
    dam.add_block({Vec3d(0, -0.1, 0), Vec3d(0.3, 0.1, 0.5)});
    dam.prepare(none);
    CHECK(has_note(dam, "does not rest as it was given"));

    for (const auto start : {Start::as_given, Start::at_rest}) {
        FluidWorld fluid(settings_for(start));
        const auto add = [&] { fluid.add_block({Vec3d::Zero(), Vec3d::Ones()}, Vec3d(0.1, 0, 0)); };
        if (start == Start::as_given)
            CHECK_NOTHROW(add());
        else
            CHECK_THROWS_WITH(add(), Catch::Matchers::Contains("at rest must have a velocity of 0"));
    }
}
