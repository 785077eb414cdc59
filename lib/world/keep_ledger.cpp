#include "world/keep_ledger.hpp"

#include "world/fluid_world_impl.hpp"

namespace flotsam {

LedgerSums& LedgerSums::operator+=(const LedgerSums& other)
{
    velocity_before += other.velocity_before;
    velocity_after += other.velocity_after;
    position_before += other.position_before;
    position_after += other.position_after;
    spin_before += other.spin_before;
    spin_after += other.spin_after;
    shift += other.shift;
    shift_spin += other.shift_spin;
    drift += other.drift;
    put_back += other.put_back;
    speed_sq_before += other.speed_sq_before;
    speed_sq_after += other.speed_sq_after;
    viscous += other.viscous;
    pressure += other.pressure;
    guard += other.guard;
    return *this;
}

/// One particle over the step. The velocities and positions that the guard found are formed once more as advance did,
/// to the bit, so that particles that it left alone give nothing to its sum.
LedgerSums FluidWorld::Impl::ledger_terms(std::size_t i, double dt) const
{
    const Vec4 sum = predicted[i] + pressure_scratch.change[i];
    const Vec4 place = fluid.position[i] + shift[i] + static_cast<Scalar>(dt) * sum;
    const auto wide = [](const Vec4& v) { return Vec3d(v.head<3>().cast<double>()); };
    const Vec3d before = wide(fluid.velocity[i]), advanced = wide(sum), after = wide(new_velocity[i]);
    const Vec3d mean = 0.5 * (before + after);
    LedgerSums t;
    t.velocity_before = before;
    t.velocity_after = after;
    t.position_before = wide(fluid.position[i]);
    t.position_after = wide(new_position[i]);
    t.spin_before = t.position_before.cross(before);
    t.spin_after = t.position_after.cross(after);
    t.shift = wide(shift[i]);
    const Vec3d rounded = wide(place) - t.position_before - t.shift - dt * advanced;
    t.shift_spin = (t.shift + rounded).cross(advanced);
    t.drift = wide(place) - t.position_before - t.shift - dt * mean;
    t.put_back = t.position_after - wide(place);
    t.speed_sq_before = before.squaredNorm();
    t.speed_sq_after = after.squaredNorm();
    t.viscous = (wide(predicted[i]) - before - dt * settings.gravity).dot(mean);
    t.pressure = wide(pressure_scratch.change[i]).dot(mean);
    t.guard = (after - advanced).dot(mean);
    return t;
}

/// Impulses about the origin, and the work that they do on owner k, to be added to its kind's.
void FluidWorld::Impl::book_owner(std::size_t k, ByCause<Wrench>& impulses, ByCause<double>& work) const
{
    Twist mean; // over the step; walls stand
    if (k >= walls.size()) {
        const BodyState& state = states[k - walls.size()];
        mean = state.predicted;
        if (state.responds) {
            mean.linear = 0.5 * (state.start.linear + state.predicted.linear + answer[k].linear);
            mean.angular = 0.5 * (state.start.angular + state.predicted.angular + answer[k].angular);
        }
    }
    const auto book = [&](const Wrench& impulse, Wrench& sum, double& energy) {
        sum += impulse.seen_at(centers[k]);
        energy += impulse.linear.dot(mean.linear) + impulse.angular.dot(mean.angular);
    };
    book(pushed[k] + filmed[k], impulses.pressure, work.pressure);
    book(rubbed[k], impulses.viscous, work.viscous);
    book(relieved[k], impulses.packing, work.packing);
    book(guarded[k], impulses.guard, work.guard);
}

void FluidWorld::Impl::keep_ledger(double dt, Bodies& port, StepReport& report)
{
    const double m = fluid.particle_mass;
    const Vec3d& g = settings.gravity;
    const LedgerSums sum = workers.ordered_sum<LedgerSums>(fluid.size(), ledger_scratch,
                                                           [&](std::size_t i) { return ledger_terms(i, dt); });
    Ledger& out = report.ledger;
    out = Ledger{};
    out.seconds = dt;
    const double volume = m / settings.rest_density * static_cast<double>(fluid.size());
    out.start = {m * sum.velocity_before, m * sum.spin_before, 0.5 * m * sum.speed_sq_before,
                 -m * g.dot(sum.position_before), volume};
    out.end = {m * sum.velocity_after, m * sum.spin_after, 0.5 * m * sum.speed_sq_after, -m * g.dot(sum.position_after),
               volume};
    out.gravity = {report.gravity_impulse, m * dt * sum.position_before.cross(g)};
    out.shift = m * sum.shift_spin;
    out.compressed = report.compression_mean * volume;

    respond(port, total, answer);
    EnergyLedger& energy = out.energy;
    for (std::size_t k = 0; k < owners(); ++k) {
        if (k < walls.size())
            book_owner(k, out.walls, energy.walls);
        else
            book_owner(k, out.bodies, energy.bodies);
    }
    energy.gravity = 0.5 * m * dt * g.dot(sum.velocity_before + sum.velocity_after);
    energy.viscous =
        -m * sum.viscous - energy.walls.viscous - energy.bodies.viscous - energy.walls.packing - energy.bodies.packing;
    energy.compression = -m * sum.pressure - energy.walls.pressure - energy.bodies.pressure;
    energy.guard = -m * sum.guard + m * g.dot(sum.put_back) - energy.walls.guard - energy.bodies.guard;
    energy.shift = -m * g.dot(sum.shift);
    energy.integration = -m * g.dot(sum.drift);
    ledger += out;
}

} // namespace flotsam
