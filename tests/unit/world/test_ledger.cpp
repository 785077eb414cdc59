#include "flotsam/world/ledger.hpp"
#include "support/catch.hpp"

using namespace flotsam;

namespace {

/// Books of a step that close: the fluid falls, and a wall and a body take some of it.
Ledger closed_step(double seconds)
{
    Ledger step;
    step.seconds = seconds;
    step.start = {Vec3d(1, 0, 0), Vec3d(0, 1, 0), 2.0, 10.0, 0.5};
    step.gravity = {Vec3d(0, 0, -3), Vec3d(0, 2, 0)};
    step.walls.pressure = {Vec3d(0, 0, -1), Vec3d(0, 0.5, 0)};
    step.bodies.viscous = {Vec3d(0.25, 0, 0), Vec3d(0, 0, 0.25)};
    step.bodies.guard = {Vec3d(0, 0.5, 0), Vec3d(0.5, 0, 0)};
    step.shift = Vec3d(0, 0, 0.125);
    step.energy.bodies.viscous = 0.25;
    step.energy.bodies.guard = 0.5;
    step.energy.viscous = 0.125;
    step.energy.compression = 1.0;
    step.energy.guard = 0.0625;
    step.energy.shift = 0.5;
    step.energy.integration = -0.25;
    step.end = {Vec3d(0.75, -0.5, -2), Vec3d(-0.5, 2.5, -0.125), 3.0, 7.3125, 0.5};
    return step;
}

} // namespace

TEST_CASE("books that close have no error, and every entry counts", "[world][ledger]")
{
    const Ledger closed = closed_step(0.1);
    CHECK(closed.errors().momentum.norm() == 0.0);
    CHECK(closed.errors().angular_momentum.norm() == 0.0);
    CHECK(closed.errors().energy == 0.0);
    CHECK(closed.errors().volume == 0.0);
    CHECK(closed.scales().momentum == 3.0);
    const auto is_wrong = [&](auto&& change) {
        Ledger ledger = closed;
        change(ledger);
        const LedgerErrors e = ledger.errors();
        return e.momentum.norm() > 0.0 || e.angular_momentum.norm() > 0.0 || e.energy != 0.0 || e.volume != 0.0;
    };
    const auto add = [](Wrench& w) { w += {Vec3d(0, 0, 0.01), Vec3d(0, 0, 0.01)}; };
    CHECK(is_wrong([&](Ledger& l) { add(l.gravity); }));
    for (ByCause<Wrench> Ledger::*solids : {&Ledger::walls, &Ledger::bodies}) {
        CHECK(is_wrong([&](Ledger& l) { add((l.*solids).pressure); }));
        CHECK(is_wrong([&](Ledger& l) { add((l.*solids).viscous); }));
        CHECK(is_wrong([&](Ledger& l) { add((l.*solids).packing); }));
        CHECK(is_wrong([&](Ledger& l) { add((l.*solids).guard); }));
    }
    for (ByCause<double> EnergyLedger::*solids : {&EnergyLedger::walls, &EnergyLedger::bodies}) {
        CHECK(is_wrong([&](Ledger& l) { (l.energy.*solids).pressure += 0.01; }));
        CHECK(is_wrong([&](Ledger& l) { (l.energy.*solids).viscous += 0.01; }));
        CHECK(is_wrong([&](Ledger& l) { (l.energy.*solids).packing += 0.01; }));
        CHECK(is_wrong([&](Ledger& l) { (l.energy.*solids).guard += 0.01; }));
    }
    for (double EnergyLedger::*entry : {&EnergyLedger::viscous, &EnergyLedger::compression, &EnergyLedger::guard,
                                        &EnergyLedger::shift, &EnergyLedger::integration})
        CHECK(is_wrong([&](Ledger& l) { l.energy.*entry += 0.01; }));
    CHECK(is_wrong([&](Ledger& l) { l.shift.x() += 0.01; }));
    CHECK(is_wrong([&](Ledger& l) { l.removed.volume += 0.01; }));
}

TEST_CASE("books of steps add up, and what goes between steps is written down", "[world][ledger]")
{
    Ledger run;
    const Ledger first = closed_step(0.1);
    Ledger second = closed_step(0.3);
    second.compressed = 4.0;
    run += first;
    CHECK(run.seconds == 0.1);
    CHECK(run.removed.volume == 0.0);
    run += second; // begins with other particles than the first ended with
    CHECK(run.seconds == Approx(0.4));
    CHECK(run.compressed == Approx(3.0)); // mean over time
    CHECK(run.removed.momentum == first.end.momentum - second.start.momentum);
    CHECK(run.removed.energy() == first.end.energy() - second.start.energy());
    CHECK(run.start.kinetic == first.start.kinetic);
    CHECK(run.end.kinetic == second.end.kinetic);
    CHECK(run.gravity.linear == 2.0 * first.gravity.linear);
    CHECK(run.energy.bodies.guard == 1.0);
    CHECK(run.errors().momentum.norm() < 1e-15);
    CHECK(run.errors().angular_momentum.norm() < 1e-15);
    CHECK(std::abs(run.errors().energy) < 1e-15);
}
