#include "world/fluid_world_impl.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flotsam {
namespace {

constexpr double kKept = 0.95; ///< of a round's velocity in the next: a push has had its effect after some 20 rounds
constexpr int kFewestRounds = 20, kMostRounds = 400;
/// Mean speeds over sqrt(g d) at which water is still, and at which it is on its way somewhere else. Still tanks 16
/// spacings deep come to 0.004 in about 350 rounds; with 0.006, in 270, half as much again of their speed later is
/// left.
constexpr double kStill = 0.004, kFlows = 0.06;

} // namespace

void FluidWorld::Impl::settle(const std::function<void(const SettleProgress&)>& on_round)
{
    const double g = settings.gravity.norm();
    if (fluid.size() == 0 || !(g > 0.0)) return;
    const std::vector<BodyState> as_read = states;
    for (BodyState& state : states) {
        state.predicted = state.start = Twist{};
        state.responds = false;
    }
    place_body_samples();
    max_pressure = std::max(max_pressure, settings.rest_density * g * spacing()); // of a single layer it would be 0
    const double dt = pressure_time_step();
    const double free_fall = std::sqrt(g * spacing()); // from half a spacing up [m/s]
    std::vector<Pose> poses;
    for (const BodyState& state : states) poses.push_back(state.pose);
    HeldBodies held(std::move(poses));
    SettleProgress progress{0, kMostRounds, free_fall, kStill * free_fall, false};
    while (!progress.is_last) {
        progress.speed = settle_round(dt, held);
        ++progress.rounds;
        progress.is_last = progress.rounds == kMostRounds ||
                           (progress.rounds >= kFewestRounds && progress.speed < progress.still_speed);
        if (on_round) on_round(progress);
    }
    if (progress.speed > kFlows * free_fall) {
        std::ostringstream note;
        note.precision(2);
        note << "the water was to start at rest, and does not rest as it was given: it still flowed at "
             << progress.speed << " m/s when it was let go";
        notes.push_back(note.str());
    }
    std::fill(fluid.velocity.begin(), fluid.velocity.end(), Vec4(Vec4::Zero()));
    max_pressure = 0.0;
    for (const Scalar p : fluid.pressure) max_pressure = std::max(max_pressure, static_cast<double>(p));
    states = as_read;
    place_body_samples();
}

/// A damped step of `dt` with the bodies held; returns the mean speed [m/s]. Viscosity would only lengthen the way.
double FluidWorld::Impl::settle_round(double dt, Bodies& held)
{
    StepReport ignored;
    look_around(ignored);
    const std::size_t n = fluid.size();
    Vec4 gravity_step = Vec4::Zero();
    gravity_step.head<3>() = (dt * settings.gravity).cast<Scalar>();
    predicted.resize(n);
    workers.for_each(n, [&](std::size_t i) { predicted[i] = fluid.velocity[i] + gravity_step; });
    total.assign(owners(), Wrench{});
    solve_pressure(dt, held, ignored);
    new_position.resize(n);
    new_velocity.resize(n);
    workers.for_each(n, [&](std::size_t i) {
        const bool stays = placed[fluid.id[i]] != 0;
        new_velocity[i] =
            stays || !is_carried(i) ? Vec4(Vec4::Zero()) : Vec4(predicted[i] + pressure_scratch.change[i]);
        new_position[i] = fluid.position[i];
        if (!stays) new_position[i] += shift[i] + static_cast<Scalar>(dt) * new_velocity[i];
        new_position[i][3] = 0;
        fluid.velocity[i] = static_cast<Scalar>(kKept) * new_velocity[i];
    });
    const double speed = mean_length(new_velocity);
    guard_relaxation();
    fluid.position.swap(new_position);
    return speed;
}

/// Whether something holds a particle up, or it lies on what is held up: all other water waits in the air. Without
/// those that lie on others the surface would fall into place only after the start.
bool FluidWorld::Impl::is_carried(std::size_t i) const
{
    if (fluid.pressure[i] > 0) return true;
    for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k)
        if (fluid.pressure[fluid_pairs.neighbour(i, k)] > 0) return true;
    return false;
}

} // namespace flotsam
