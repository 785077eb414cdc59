#include "world/fluid_world_impl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flotsam {

ComplementaritySolver& FluidWorld::Impl::solver()
{
    switch (settings.pressure.solver) {
    case PressureSettings::Solver::iisph:
        return relaxed_jacobi;
    case PressureSettings::Solver::mprgp:
        return mprgp;
    case PressureSettings::Solver::spg:
        break;
    }
    // Enclosed water has no surface that moves, and is stiff: there conjugate gradients are at their best, and leave
    // less of the smooth errors, which no shift could take out.
    if (steps_enclosed > 0) return mprgp;
    return spectral_gradient;
}

/// Zero for walls and for bodies that do not respond or touch no fluid.
void FluidWorld::Impl::build_mobility(Bodies& port)
{
    mobility.assign(owners(), Eigen::Matrix<double, 6, 6>::Zero());
    if (!port.own_mobility(std::span(mobility).subspan(walls.size()))) find_mobility(port);
    for (std::size_t k = walls.size(); k < owners(); ++k) {
        const bool is_touched = contacts.start[k] != contacts.start[k + 1];
        if (!states[k - walls.size()].responds || !is_touched) mobility[k].setZero();
    }
}

void FluidWorld::Impl::find_mobility(Bodies& port)
{
    unit.assign(owners(), Wrench{});
    for (std::size_t k = walls.size(); k < owners(); ++k) {
        if (!states[k - walls.size()].responds || contacts.start[k] == contacts.start[k + 1]) continue;
        for (int c = 0; c < 6; ++c) {
            (c < 3 ? unit[k].linear[c] : unit[k].angular[c - 3]) = 1.0;
            respond(port, unit, answer);
            mobility[k].col(c) << answer[k].linear, answer[k].angular;
            unit[k] = Wrench{};
        }
        mobility[k] = 0.5 * (mobility[k] + mobility[k].transpose()).eval();
    }
}

double FluidWorld::Impl::mean_length(std::span<const Vec4> vectors)
{
    return workers.ordered_sum<double>(vectors.size(), sums, [&](std::size_t i) {
        return static_cast<double>(vectors[i].norm());
    }) / static_cast<double>(vectors.size());
}

/// The system of the pairs and contacts as they are, with fluid_diagonal.
PressureSystem FluidWorld::Impl::pressure_system()
{
    const PressureSystem system(fluid_pairs, fluid.position, contacts, fluid.particle_mass, workers, pressure_scratch,
                                {&new_position, &new_velocity});
    fluid_diagonal.resize(fluid.size());
    system.fluid_diagonal(fluid_diagonal);
    return system;
}

/// Positions are shifted so that the densities fall to rest density; bodies stand still in it and no momentum moves.
SolveResult FluidWorld::Impl::solve_shift(const PressureSystem& system)
{
    constexpr int kMostShiftIterations = 200; // what takes more has nowhere to be shifted to
    const std::size_t n = fluid.size();
    const Scalar rho0 = static_cast<Scalar>(settings.rest_density);
    source.resize(n);
    shift.assign(n, Vec4::Zero());
    multiplier.assign(n, Scalar(0)); // of the shift, until the velocities are solved for
    workers.for_each(n, [&](std::size_t i) { source[i] = fluid.density[i] - rho0; });
    pressure_operator.bind(system, nullptr, owners());
    SolveGoal goal;
    goal.scale = 1.0 / settings.rest_density;
    goal.tolerance = settings.pressure.tolerance;
    goal.max_iterations = std::min(kMostShiftIterations, settings.pressure.max_iterations);
    goal.min_iterations = 0;
    const SolveResult result = solver().solve(pressure_operator, source, fluid_diagonal, goal, multiplier);
    system.velocity_change(multiplier, shift);
    // The system is linear in the shift only for a fraction of a spacing.
    const Scalar longest = static_cast<Scalar>(0.1 * spacing());
    workers.for_each(n, [&](std::size_t i) {
        const Scalar length = shift[i].norm();
        if (length > longest) shift[i] *= longest / length;
    });
    return result;
}

/// Enclosed water has no shift that takes its error out: a Krylov method then "solves" it by a huge one. In water at
/// rest the mean stays below 0.02 d (from a step to the next: 0.003 d); without room it starts at 0.05 d. Water that
/// strikes something is shifted as far, but has a surface.
bool FluidWorld::Impl::is_enclosed(const SolveResult& of_shift)
{
    constexpr double kMean = 0.03, kAny = 0.001; // of the spacing; for a solve that has not come to its end
    const double most = (of_shift.converged ? kMean : kAny) * spacing();
    if (fluid.size() == 0 || (of_shift.converged && mean_length(shift) <= most)) return false;
    const EnclosedWater::Water water{fluid.position,        fluid_pairs, new_velocity,
                                     settings.rest_density, spacing(),   settings.dimensions};
    return enclosed_water.mean_shift(water, shift) > most;
}

/// The shift of the split source; false where the source is the published one, for this step at least. Water that
/// solids enclose has nowhere to be shifted to, and only the published source moves the solids: its shift is
/// dropped for it, and where that happens step after step, so are those of some steps to come.
bool FluidWorld::Impl::shift_if_possible(const PressureSystem& system, StepReport& report)
{
    constexpr int kFailures = 3, kStepsWithout = 50, kStepsEnclosed = 1000;
    steps_enclosed = std::max(0, steps_enclosed - 1);
    if (settings.pressure.source == PressureSettings::Source::split && steps_without_shift == 0) {
        const SolveResult result = solve_shift(system);
        const bool fails = is_enclosed(result);
        report.shift_iterations = result.iterations;
        report.products += result.products;
        report.converged = result.converged && !fails;
        failed_shifts = fails ? failed_shifts + 1 : 0;
        if (!fails) return true;
        steps_enclosed = kStepsEnclosed;
        if (failed_shifts >= kFailures) {
            failed_shifts = kFailures - 1; // the next one that fails is enough
            steps_without_shift = kStepsWithout;
        }
    } else {
        steps_without_shift = std::max(0, steps_without_shift - 1);
    }
    shift.assign(fluid.size(), Vec4::Zero());
    return false;
}

/// A part of the residual that no pressure at all would leave. The mean over all particles says little of smooth
/// errors: in water N layers deep, gravity compresses but one layer of the N, and an error of the whole column's
/// acceleration leaves no more than that.
double FluidWorld::Impl::part_of_cold_residual(double scale)
{
    constexpr double kPart = 0.2, kLeast = 1e-7; // the least: rounding
    if (source.empty()) return kLeast;
    const double sum = workers.ordered_sum<double>(
        source.size(), sums, [&](std::size_t i) { return std::max(0.0, static_cast<double>(source[i])); });
    return std::max(kLeast, kPart * scale * sum / static_cast<double>(source.size()));
}

/// Errors of a solve are kicks, and dissipation is in proportion to the noise that they make: in water that is nearly
/// still (1 cm/s at 2 cm and 4 ms) they would keep a noise of their own alive. 2-D, 25 layers: mean speed after 20 s
/// 0.36 % of sqrt(g depth), and not sinking, at 1.5e-5 throughout; 0.37 at 5e-6, 0.11 and sinking at 3e-6.
double FluidWorld::Impl::velocity_tolerance(double dt)
{
    constexpr double kPart = 0.005, kLeast = 0.05; // of what the water moves in a step; of the setting
    const double most = settings.pressure.velocity_tolerance;
    if (fluid.size() == 0) return most;
    return std::clamp(kPart * mean_length(fluid.velocity) * dt / spacing(), kLeast * most, most);
}

void FluidWorld::Impl::solve_pressure(double dt, Bodies& port, StepReport& report)
{
    constexpr int kMostRounds = 6; // of the solve, until joints and contacts hold and yield as it has them
    const std::size_t n = fluid.size();
    const PressureSystem system = pressure_system();
    workers.for_each(n, [&](std::size_t i) {
        if (is_pinched[i] != 0) fluid_diagonal[i] = 0; // carries no pressure
    });
    const bool split = shift_if_possible(system, report);
    // The split leaves no density error in the pressure, so all of the last one is a good start; with the published
    // source a full start integrates the error and rings.
    const Scalar keep = split ? Scalar(1) : Scalar(0.5);
    multiplier.resize(n);
    workers.for_each(n, [&](std::size_t i) {
        multiplier[i] = keep * static_cast<Scalar>(dt) * fluid.pressure[i] / (fluid.density[i] * fluid.density[i]);
    });

    pushed.resize(owners());
    bool again = true;
    for (report.rounds = 0; again && report.rounds < kMostRounds; ++report.rounds) {
        solve_velocities(system, dt, split, port, report);
        system.impulses(multiplier, pushed);
        again = is_strong() && revise(port);
    }
    report.converged = report.converged && !again;

    system.velocity_change(multiplier, pressure_scratch.change);
    for (std::size_t k = 0; k < owners(); ++k) total[k] += pushed[k];
    const Scalar inv_dt = static_cast<Scalar>(1.0 / dt);
    workers.for_each(
        n, [&](std::size_t i) { fluid.pressure[i] = multiplier[i] * fluid.density[i] * fluid.density[i] * inv_dt; });
}

/// Solids that all but touch fill nearly all that a particle between them sees, and no pressure takes it out of there:
/// some such particles under a heavy raft on the floor would carry all of it, like grains of sand, at sixty times its
/// mean pressure, and the step would shrink to an eighth. They are left without pressure and shift, and the solids
/// meet, with a film between them. The shares are those between two planes a quarter of a spacing apart. A particle in
/// the corner of three walls sees as much, but all on one side: pressure takes it out.
void FluidWorld::Impl::find_pinched()
{
    const Scalar most = settings.dimensions == 2 ? Scalar(0.9) : Scalar(0.75); // of the rest density, from solids
    const Scalar one_sided = static_cast<Scalar>(0.15 / spacing()); // at a plane 0.55, in corners 0.24 to 0.4 [1/m]
    const auto gradient = [&](std::size_t i) {
        Vec3 sum = Vec3::Zero();
        for (std::uint32_t k = boundary_pairs.start[i]; k < boundary_pairs.start[i + 1]; ++k) {
            const std::uint32_t b = boundary_pairs.index[k];
            sum += boundary.volume[b] * boundary_pairs.slope[k] * (fluid.position[i] - boundary.position[b]).head<3>();
        }
        return sum.norm();
    };
    is_pinched.resize(fluid.size());
    workers.for_each(fluid.size(), [&](std::size_t i) {
        is_pinched[i] = boundary_pairs.kernel_sum[i] > most && gradient(i) < one_sided ? 1 : 0;
    });
}

/// One solve for `multiplier` with the bodies' response as it is.
void FluidWorld::Impl::solve_velocities(const PressureSystem& system, double dt, bool split, Bodies& port,
                                        StepReport& report)
{
    const std::size_t n = fluid.size();
    const PressureSettings& pressure = settings.pressure;
    const double rho0 = settings.rest_density;
    // What the shift has taken out is none of the velocities' work. In place of a shift they do it, in the time of some
    // twenty of the largest steps: in one, 2 % of a column of 40 spacings would be a jump by nearly one. (In time, not
    // in steps: a share of the error in each step takes a pressure in proportion to 1 / dt^2, for which steps become
    // shorter, until the water shoots a piston out.)
    const bool published = pressure.source == PressureSettings::Source::published;
    const Scalar in_time = static_cast<Scalar>(0.05 * std::min(1.0, dt / settings.max_time_step));
    const Scalar share = split ? Scalar(0) : published ? Scalar(1) : in_time;
    const Scalar most_error = published ? std::numeric_limits<Scalar>::infinity() : static_cast<Scalar>(0.02 * rho0);
    source.resize(n);
    system.density_rate(predicted, twists, source);
    const Scalar inv_dt = static_cast<Scalar>(1.0 / dt);
    workers.for_each(n, [&](std::size_t i) {
        const Scalar error = fluid.density[i] - static_cast<Scalar>(rho0);
        source[i] += inv_dt * (error > 0 ? share * std::min(most_error, error) : error);
    });
    std::span<const Scalar> diagonal = fluid_diagonal;
    const bool preconditions = pressure.solver != PressureSettings::Solver::iisph;
    if (is_strong()) {
        build_mobility(port);
        if (preconditions) preconditioner.build(system, mobility, fluid_diagonal);
        coupled_diagonal.assign(fluid_diagonal.begin(), fluid_diagonal.end());
        system.add_response_diagonal(mobility, coupled_diagonal);
        diagonal = coupled_diagonal;
    }
    const auto answer_impulses = [&](std::span<const Wrench> impulses, std::span<Twist> answers) {
        respond(port, impulses, answers);
    };
    const OwnerResponse response = answer_impulses;
    pressure_operator.bind(system, is_strong() ? &response : nullptr, owners());
    if (is_strong() && preconditions) pressure_operator.set_preconditioner(&preconditioner);
    SolveGoal goal;
    goal.scale = dt / rho0;
    goal.tolerance =
        published ? pressure.tolerance : std::min(velocity_tolerance(dt), part_of_cold_residual(goal.scale));
    goal.max_iterations = pressure.max_iterations;
    const SolveResult result = solver().solve(pressure_operator, source, diagonal, goal, multiplier);
    report.iterations += result.iterations;
    report.products += result.products;
    report.residual = result.residual;
    report.converged = report.converged && result.converged;
}

/// Whether joints and contacts yield or hold otherwise than the last solve had it; then with new twists of the bodies.
bool FluidWorld::Impl::revise(Bodies& port)
{
    offered.assign(total.begin(), total.end());
    for (std::size_t k = 0; k < owners(); ++k) offered[k] += pushed[k];
    if (!port.revise(std::span<const Wrench>(offered).subspan(walls.size()), states)) return false;
    predict_twists(port);
    return true;
}

} // namespace flotsam
