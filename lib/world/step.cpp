#include "world/fluid_world_impl.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/sph/density.hpp"
#include "world/boundary_calibration.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <string>

namespace flotsam {
namespace {

/// Adds the seconds of its life to `sum`.
class StageClock {
  public:
    explicit StageClock(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
    ~StageClock() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
    StageClock(const StageClock&) = delete;
    StageClock& operator=(const StageClock&) = delete;

  private:
    double& sum_;
    std::chrono::steady_clock::time_point start_;
};

template <class T>
void reorder(std::vector<T>& values, std::vector<T>& scratch, std::span<const std::uint32_t> order,
             const Workers& workers)
{
    scratch.resize(values.size());
    workers.for_each(values.size(), [&](std::size_t i) { scratch[i] = values[order[i]]; });
    values.swap(scratch);
}

/// A single NaN of a body would spread through the water around it, for good.
void require_usable(const BodyState& state, std::size_t body)
{
    const auto require_finite = [&](const Vec3d& v, const char* what) {
        if (!v.allFinite())
            require(false, "body " + std::to_string(body) + " must have a finite " + what, v.transpose());
    };
    require_finite(state.pose.position, "position [m]");
    require_finite(state.start.linear, "velocity [m/s]");
    require_finite(state.start.angular, "angular velocity [rad/s]");
    require_finite(state.predicted.linear, "velocity at the end of the step [m/s]");
    require_finite(state.predicted.angular, "angular velocity at the end of the step [rad/s]");
    constexpr double kUnit = 1e-3; // wide enough for any engine's rounding
    const Quatd& turn = state.pose.orientation;
    if (!(std::abs(turn.norm() - 1.0) < kUnit))
        require(false, "body " + std::to_string(body) + " must have an orientation of norm 1", turn.norm());
}

/// In 2-D. A body that is turned moves out of the plane by rounding errors, and water that gets any of that buckles out
/// of it, a million times as far each tenth of a second.
void keep_in_plane(Twist& twist)
{
    twist.linear.y() = 0.0;
    twist.angular.x() = twist.angular.z() = 0.0;
}

} // namespace

StepReport FluidWorld::Impl::step(double dt, Bodies& port)
{
    StepReport report;
    report.dt = dt;
    {
        const StageClock clock(report.seconds.bodies);
        read_bodies(dt, port);
        take_in_changes(report);
        remove_fallen(report);
        place_body_samples();
        sample_walls_in_reach();
    }
    {
        const StageClock clock(report.seconds.neighbours);
        find_neighbours();
    }
    {
        const StageClock clock(report.seconds.density);
        measure_density(report);
    }
    {
        const StageClock clock(report.seconds.forces);
        add_forces(dt, port, report);
    }
    {
        const StageClock clock(report.seconds.pressure);
        solve_pressure(dt, port, report);
    }
    {
        const StageClock clock(report.seconds.advance);
        advance(dt, port, report);
    }
    time += dt;
    last_dt = dt;
    return report;
}

void FluidWorld::Impl::read_bodies(double dt, Bodies& port)
{
    require(port.size() == bodies.size(), "the port must have the bodies that were added to the fluid world",
            port.size());
    read_states.assign(bodies.size(), BodyState{});
    port.read(dt, read_states);
    for (std::size_t k = 0; k < bodies.size(); ++k)
        if (!bodies[k].mesh.empty()) require_usable(read_states[k], k); // others were removed
    if (settings.dimensions == 2)
        for (BodyState& state : read_states) {
            keep_in_plane(state.start);
            keep_in_plane(state.predicted);
        }
    states.swap(read_states);
    note_other_gravity(port);
}

/// Nothing is wrong with it, but it is rarely meant.
void FluidWorld::Impl::note_other_gravity(const Bodies& port)
{
    constexpr double kSame = 1e-5; // of it: engines with single precision round it
    if (is_gravity_noted) return;
    const std::optional<Vec3d> theirs = port.gravity();
    const bool is_felt = std::any_of(states.begin(), states.end(), [](const BodyState& s) { return s.responds; });
    if (!is_felt || !theirs || (*theirs - settings.gravity).norm() <= kSame * settings.gravity.norm()) return;
    is_gravity_noted = true;
    const auto components = [](const Vec3d& v) {
        std::ostringstream text;
        text << "(" << v.x() << ", " << v.y() << ", " << v.z() << ") m/s^2";
        return text.str();
    };
    notes.push_back("bodies have a gravity of " + components(*theirs) + ", the water one of " +
                    components(settings.gravity) + ": they float as they would under neither");
}

void FluidWorld::Impl::place_body_samples()
{
    centers.assign(owners(), Vec3d::Zero());
    twists.assign(owners(), Twist{});
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        centers[walls.size() + k] = states[k].pose.position;
        twists[walls.size() + k] = states[k].predicted;
    }
    workers.for_each(boundary.size(), [&](std::size_t b) {
        const std::size_t owner = static_cast<std::size_t>(boundary.owner[b]);
        if (owner < walls.size()) return;
        const Pose& pose = states[owner - walls.size()].pose;
        const Vec3d arm = pose.orientation * boundary.position_body[b];
        boundary.position[b].head<3>() = (pose.position + arm).cast<Scalar>();
        boundary.velocity[b].head<3>() = twists[owner].at(arm).cast<Scalar>();
        // A turn of a rounding error out of the plane would put samples into other cells.
        if (settings.dimensions == 2) boundary.position[b][1] = boundary.velocity[b][1] = 0;
        if (boundary.normal.empty()) return;
        const Vec3d normal = pose.orientation * boundary.normal_body[b].head<3>().cast<double>();
        boundary.normal[b].head<3>() = normal.cast<Scalar>();
    });
}

void FluidWorld::Impl::find_neighbours()
{
    const std::size_t max_cells = std::max<std::size_t>(1u << 18, 16 * (fluid.size() + boundary.size()));
    grid = CellGrid::around(fluid.position, boundary.position, support(), max_cells);
    fluid_cells.build(grid, fluid.position, workers);
    sort_particles();
    boundary_cells.build(grid, boundary.position, workers);
    paired_samples = boundary.size();
    kernel.visit([&](const auto& spline) {
        search.find(spline, grid, fluid_cells, fluid.position, workers, fluid_pairs);
        search.find(spline, grid, boundary_cells, fluid.position, false, boundary.volume, workers, boundary_pairs);
    });
    hide_behind_sheets();
}

void FluidWorld::Impl::hide_behind_sheets()
{
    if (boundary.normal.empty()) return;
    const auto hide = [&](std::size_t owner, const Sheet* sheet, const Pose& pose) {
        if (sheet == nullptr) return;
        const double rim = rim_weight(sheet->thickness(), settings.kernel, spacing(), settings.dimensions);
        screen.hide({owner, *sheet, pose, rim}, kernel, fluid.position, boundary, workers, fluid_pairs, boundary_pairs);
    };
    for (std::size_t k = 0; k < walls.size(); ++k) hide(k, walls[k].sheet.get(), Pose{});
    for (std::size_t k = 0; k < bodies.size(); ++k)
        if (bodies[k].query) hide(walls.size() + k, bodies[k].sheet.get(), states[k].pose);
}

void FluidWorld::Impl::sort_particles()
{
    const std::span<const std::uint32_t> order = fluid_cells.order;
    reorder(fluid.position, new_velocity, order, workers);
    reorder(fluid.velocity, new_velocity, order, workers);
    reorder(fluid.pressure, source, order, workers);
    reorder(fluid.id, fluid_cells.cell, order, workers);
    for (std::size_t i = 0; i < fluid.size(); ++i) fluid_cells.order[i] = static_cast<std::uint32_t>(i);
}

void FluidWorld::Impl::measure_density(StepReport& report)
{
    compute_density(fluid_pairs.kernel_sum, boundary_pairs.kernel_sum, kernel.value(0), fluid.particle_mass,
                    settings.rest_density, workers, fluid.density);
    contact_builder.build(boundary_pairs, fluid.position, boundary, centers, settings.rest_density, workers, contacts);
    find_pinched();
    const double rho0 = settings.rest_density;
    const auto compression = [&](std::size_t i) {
        return std::max(0.0, static_cast<double>(fluid.density[i]) / rho0 - 1.0);
    };
    if (fluid.size() == 0) return;
    report.compression_mean =
        workers.ordered_sum<double>(fluid.size(), sums, compression) / static_cast<double>(fluid.size());
    report.compression_max =
        workers.ordered_sum<MaxOf>(fluid.size(), max_scratch, [&](std::size_t i) { return MaxOf{compression(i)}; })
            .value;
}

void FluidWorld::Impl::add_forces(double dt, Bodies& port, StepReport& report)
{
    predicted.resize(fluid.size());
    const Vec4 gravity_step(static_cast<Scalar>(settings.gravity.x() * dt),
                            static_cast<Scalar>(settings.gravity.y() * dt),
                            static_cast<Scalar>(settings.gravity.z() * dt), Scalar(0));
    workers.for_each(fluid.size(), [&](std::size_t i) { predicted[i] = fluid.velocity[i] + gravity_step; });
    report.gravity_impulse = settings.gravity * (dt * fluid.particle_mass * static_cast<double>(fluid.size()));
    total.assign(owners(), Wrench{});
    const ForceScratch scratch{&pressure_scratch.change, &shift, &new_velocity, &new_position};
    if (settings.kinematic_viscosity > 0.0 || settings.dissipation > 0.0) {
        const ViscositySettings viscous{settings.kinematic_viscosity, settings.dissipation, spacing(),
                                        settings.rest_density, settings.dimensions};
        viscosity.add(viscous, dt, fluid, boundary, fluid_pairs, boundary_pairs, centers, workers, scratch, predicted,
                      total);
    }
    answer.assign(owners(), Twist{});
    for (std::size_t k = 0; k < bodies.size(); ++k) answer[walls.size() + k] = states[k].start;
    if (settings.kinematic_viscosity > 0.0 && !bodies.empty()) {
        const SkinFrictionSettings skin{settings.kinematic_viscosity, spacing(), settings.rest_density,
                                        settings.dimensions};
        skin_friction.add(
            skin, dt, fluid, boundary, boundary_pairs, contacts, walls.size(), centers, answer,
            [&](std::span<const Wrench> impulses, std::span<Twist> answers) { respond(port, impulses, answers); },
            workers, predicted, total);
    }
    rubbed = total;
    relieved.assign(owners(), Wrench{});
    if (settings.packing_relief > 0.0) {
        const PackingStressSettings packing{settings.packing_relief, settings.rest_density, settings.dimensions};
        slip.update(dt, spacing(), settings.gravity.norm(), fluid, contacts, walls.size(), centers, answer, workers);
        packing_stress.relieve(packing, dt, fluid, fluid_pairs,
                               {boundary, boundary_pairs, contacts, centers, slip.shares()}, workers, scratch,
                               predicted, relieved);
    }
    fill_films(dt, port);
    for (std::size_t k = 0; k < owners(); ++k) total[k] += relieved[k] + filmed[k];
    predict_twists(port);
}

/// Films know nothing of the pressures that answer them: they may kick a body, as if it were alone, by no more than can
/// be answered within a step.
void FluidWorld::Impl::fill_films(double dt, Bodies& port)
{
    constexpr double kDelay = 5.0;    // of the largest steps
    constexpr double kMostKick = 4.0; // spacings a step
    film_solids.clear();
    for (const Wall& wall : walls) film_solids.push_back({wall.query.get(), Pose{}, Twist{}, wall.side, false});
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        const BodyState& state = states[k];
        film_solids.push_back({bodies[k].query.get(), state.pose, state.start, WallSide::outside, state.responds});
    }
    const WaterFilmSettings film{spacing(), settings.gravity, settings.rest_density, settings.dimensions,
                                 kDelay * settings.max_time_step};
    films.fill(film, dt, {fluid, fluid_pairs, boundary_pairs, contacts, boundary.owner, is_pinched}, film_solids,
               guard);
    filmed.assign(owners(), Wrench{});
    if (films.empty()) return;
    films.add_impulses(dt, filmed);
    respond(port, filmed, answer);
    film_shares.assign(owners(), 1.0);
    for (std::size_t k = walls.size(); k < owners(); ++k) {
        const double kick = answer[k].linear.norm();
        film_shares[k] = std::min(1.0, kMostKick * spacing() / (dt * std::max(kick, 1e-300)));
    }
    films.limit(film_shares);
    filmed.assign(owners(), Wrench{});
    films.add_impulses(dt, filmed);
}

/// At the end of the step without pressure.
void FluidWorld::Impl::predict_twists(Bodies& port)
{
    answer.resize(owners());
    respond(port, total, answer);
    for (std::size_t k = walls.size(); k < owners(); ++k) {
        const Twist& without_fluid = states[k - walls.size()].predicted;
        twists[k] = {without_fluid.linear + answer[k].linear, without_fluid.angular + answer[k].angular};
    }
}

void FluidWorld::Impl::respond(Bodies& port, std::span<const Wrench> impulses, std::span<Twist> answers) const
{
    std::fill_n(answers.begin(), walls.size(), Twist{});
    if (bodies.empty()) return;
    port.respond(impulses.subspan(walls.size()), answers.subspan(walls.size()));
    if (settings.dimensions == 2)
        for (Twist& twist : answers) keep_in_plane(twist);
}

void FluidWorld::Impl::advance(double dt, Bodies& port, StepReport& report)
{
    const std::size_t n = fluid.size();
    const Scalar step_size = static_cast<Scalar>(dt);
    new_position.resize(n);
    new_velocity.resize(n);
    workers.for_each(n, [&](std::size_t i) {
        new_velocity[i] = predicted[i] + pressure_scratch.change[i];
        new_position[i] = fluid.position[i] + shift[i] + step_size * new_velocity[i];
        new_position[i][3] = 0;
    });
    {
        const StageClock clock(report.seconds.walls);
        guard_walls(dt, port, report);
    }
    if (settings.dimensions == 2) // walls' faces turn it back across the plane by rounding errors, too
        workers.for_each(n, [&](std::size_t i) { new_position[i][1] = new_velocity[i][1] = 0; });
    keep_ledger(dt, port, report);
    fluid.position.swap(new_position);
    fluid.velocity.swap(new_velocity);
    const double fastest_sq =
        workers
            .ordered_sum<MaxOf>(
                n, max_scratch,
                [&](std::size_t i) { return MaxOf{static_cast<double>(fluid.velocity[i].squaredNorm())}; })
            .value;
    report.max_speed = std::sqrt(fastest_sq);
    report.fluid_momentum = report.ledger.end.momentum;
    max_pressure = workers
                       .ordered_sum<MaxOf>(n, max_scratch,
                                           [&](std::size_t i) { return MaxOf{static_cast<double>(fluid.pressure[i])}; })
                       .value;
    max_speed = report.max_speed;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        max_speed = std::max(max_speed, states[k].predicted.linear.norm());
    }
    for (std::size_t k = 0; k < owners(); ++k)
        (k < walls.size() ? report.wall_impulse : report.body_impulse) += total[k].linear;
    if (!bodies.empty()) port.apply(std::span<const Wrench>(total).subspan(walls.size()));
}

void FluidWorld::Impl::guard_walls(double dt, Bodies& port, StepReport& report)
{
    respond(port, total, answer);
    motion.resize(owners());
    guarded.assign(owners(), Wrench{});
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        const BodyState& state = states[k];
        const std::size_t owner = walls.size() + k;
        // twists already hold the answer to the viscous part of `total`; `answer` holds all of it.
        const Twist twist{state.predicted.linear + answer[owner].linear,
                          state.predicted.angular + answer[owner].angular};
        motion[owner] = {state.pose, moved(state.pose, twist, dt), twist};
        bodies[k].last_pose = motion[owner].after;
    }
    const auto answer_impulses = [&](std::span<const Wrench> impulses, std::span<Twist> changes) {
        respond(port, impulses, changes);
    };
    const WallGuard::Response response = answer_impulses;
    const GuardReport guard_report = guard.stop(fluid.position, new_position, new_velocity, motion, fluid.particle_mass,
                                                workers, &response, guarded);
    report.leaks_stopped = guard_report.stopped;
    report.leaked = guard_report.leaked;
    for (std::size_t k = 0; k < owners(); ++k) {
        total[k] += guarded[k];
        report.guard_impulse += guarded[k].linear;
    }
}

} // namespace flotsam
