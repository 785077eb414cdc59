#include "scene/run_tally.hpp"

#include "geometry/basin_query.hpp"
#include "geometry/wetted_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace flotsam::scene {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
/// A water line is a median of many levels: not one for each step.
constexpr int kDraftsMeasured = 32;

void add_seconds(StageSeconds& sum, const StageSeconds& step)
{
    sum.bodies += step.bodies;
    sum.neighbours += step.neighbours;
    sum.density += step.density;
    sum.forces += step.forces;
    sum.pressure += step.pressure;
    sum.advance += step.advance;
    sum.walls += step.walls;
}

} // namespace

std::optional<double> read_probe(const FluidWorld& fluid, const SceneProbe& probe)
{
    if (probe.kind == SceneProbe::Kind::level) return fluid.level_at(probe.point.x(), probe.point.y());
    return fluid.pressure_at(probe.point);
}

RunTally::RunTally(const SceneFile& scene, const PreparedScene& prepared, const SceneWorld& world)
    : scene_(scene), prepared_(prepared), world_(world),
      wall_forces_(scene.walls.size(), TimeMean<Vec3d>(Vec3d::Zero())),
      probes_(scene.probes.size(), TimeMean<double>(0.0)), bodies_(scene.bodies.size()), joints_(scene.joints.size())
{
}

void RunTally::add(const StepReport& step)
{
    add_totals(step);
    if (world_.fluid().time() > 0.75 * scene_.duration)
        add_last_quarter(step);
    else
        for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_[k].velocity_before = world_.body(k).twist.linear;
}

void RunTally::add_totals(const StepReport& step)
{
    const int iterations = step.iterations + step.shift_iterations;
    ++steps_;
    iterations_ += iterations;
    most_iterations_ = std::max(most_iterations_, iterations);
    rounds_ += step.rounds;
    most_rounds_ = std::max(most_rounds_, step.rounds);
    disagreement_.add(step.disagreement, step.dt);
    most_disagreement_ = std::max(most_disagreement_, step.disagreement);
    unconverged_ += step.converged ? 0 : 1;
    leaks_stopped_ += step.leaks_stopped;
    leaked_ = std::max(leaked_, step.leaked);
    fallen_ += step.fallen_particles;
    compression_max_ = std::max(compression_max_, step.compression_max);
    add_seconds(seconds_, step.seconds);
}

void RunTally::add_last_quarter(const StepReport& step)
{
    const FluidWorld& fluid = world_.fluid();
    compression_.add(step.compression_mean, step.dt);
    for (std::size_t k = 0; k < wall_forces_.size(); ++k)
        wall_forces_[k].add(fluid.wall_force(static_cast<int>(k)), step.dt);
    for (std::size_t k = 0; k < probes_.size(); ++k)
        if (const auto value = read_probe(fluid, scene_.probes[k])) probes_[k].add(*value, step.dt);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const Wrench wrench = fluid.fluid_wrench(static_cast<int>(k));
        bodies_[k].force.add(wrench.linear, step.dt);
        bodies_[k].torque.add(wrench.angular, step.dt);
    }
    for (std::size_t k = 0; k < joints_.size(); ++k) {
        joints_[k].force.add(world_.joint(k).wrench.linear, step.dt);
        joints_[k].torque.add(world_.joint(k).wrench.angular, step.dt);
    }
    if (bodies_.empty() || fluid.time() < next_draft_) return;
    next_draft_ = std::max(next_draft_, 0.75 * scene_.duration) + 0.25 * scene_.duration / kDraftsMeasured;
    measure_drafts(1.0);
}

void RunTally::measure_drafts(double dt)
{
    if (!is_level(scene_.gravity)) return;
    const std::vector<BodyState> states = world_.body_states();
    const std::vector<std::optional<double>> levels = world_.fluid().waterlines(states);
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        if (!levels[k]) continue;
        bodies_[k].waterline.add(*levels[k], dt);
        bodies_[k].draft.add(*levels[k] - lowest_point(prepared_.bodies[k].mesh, states[k].pose), dt);
    }
}

RunReport RunTally::report() const
{
    RunReport report;
    report.scene = scene_.file.string();
    report.particle_spacing = scene_.particle_spacing;
    report.rest_density = scene_.fluid.density;
    report.steps = steps_;
    report.stage_seconds = seconds_;
    report_fluid(report);
    report.ledger = world_.fluid().ledger();
    for (const TimeMean<Vec3d>& force : wall_forces_)
        report.wall_force_mean.push_back(force.mean().value_or(Vec3d::Zero()));
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        report.bodies.push_back(report_body(k));
        note_loads(k, report.bodies.back(), report.notes);
    }
    for (std::size_t k = 0; k < joints_.size(); ++k) report.joints.push_back(report_joint(k));
    for (std::size_t k = 0; k < probes_.size(); ++k)
        report.probes.push_back(
            {scene_.probes[k].name, probes_[k].mean(), read_probe(world_.fluid(), scene_.probes[k])});
    return report;
}

void RunTally::report_fluid(RunReport& report) const
{
    report.simulated_seconds = world_.fluid().time();
    report.fluid_particles = world_.fluid().fluid().size();
    report.boundary_samples = world_.fluid().boundary().size();
    report.state_hash = world_.fluid().state_hash();
    const auto per_step = [&](std::int64_t count) {
        return steps_ > 0 ? static_cast<double>(count) / static_cast<double>(steps_) : 0.0;
    };
    report.iterations = {per_step(iterations_), static_cast<double>(most_iterations_)};
    report.coupling_rounds = {per_step(rounds_), static_cast<double>(most_rounds_)};
    report.disagreement = {disagreement_.mean().value_or(0.0), most_disagreement_};
    report.unconverged_steps = unconverged_;
    report.compression = {compression_.mean().value_or(0.0), compression_max_};
    report.leaked = leaked_;
    report.leaks_stopped = leaks_stopped_;
    if (fallen_ > 0)
        report.notes.push_back(std::to_string(fallen_) +
                               " particles left over open sides, fell out of reach and were removed");
}

BodyReport RunTally::report_body(std::size_t k) const
{
    const PreparedBody& body = prepared_.bodies[k];
    const BodyNow now = world_.body(k);
    const Quatd rotation = now.pose.orientation * body.frame.orientation.conjugate();
    BodyReport report;
    report.name = scene_.bodies[k].name;
    report.volume = body.volume;
    report.position = now.pose.position;
    report.rotation_deg = rotation_vector(rotation) * kDegrees;
    report.velocity = now.twist.linear;
    report.tilt_deg = kDegrees * std::acos(std::clamp((rotation * Vec3d::UnitZ()).z(), -1.0, 1.0));
    report.waterline = bodies_[k].waterline.mean();
    report.draft = bodies_[k].draft.mean();
    report.force_fluid_mean = bodies_[k].force.mean().value_or(Vec3d::Zero());
    report.torque_fluid_mean = bodies_[k].torque.mean().value_or(Vec3d::Zero());
    if (!(body.mass > 0.0)) return report;
    report.mass = body.mass;
    if (!is_level(scene_.gravity)) return report;
    report.exact_draft = exact_draft(body, now.pose, report.waterline);
    return report;
}

/// Whether contacts, joints or locks bear on a body that could float: what the water and gravity do not account for in
/// its momentum.
void RunTally::note_loads(std::size_t k, const BodyReport& body, std::vector<std::string>& notes) const
{
    constexpr double kNoted = 0.05; // of the weight
    const double seconds = bodies_[k].force.seconds();
    const bool is_free = scene_.bodies[k].motion == SceneBody::Motion::dynamic;
    if (!is_free || !body.exact_draft || !(seconds > 0.0)) return;
    const double mass = body.mass.value_or(0.0), weight = mass * scene_.gravity.norm();
    const double risen = body.velocity.z() - bodies_[k].velocity_before.z();
    const double load = mass * risen / seconds - body.force_fluid_mean.z() + weight;
    if (std::abs(load) < kNoted * weight) return;
    std::ostringstream note;
    note.precision(3);
    note << "bodies[" << k << "] (\"" << body.name << "\") was not afloat on its own: over the last quarter of the run "
         << "contacts, joints or locks " << (load > 0.0 ? "held it up" : "pressed it down") << " with "
         << std::abs(load) << " N of its weight of " << weight << " N; exact_draft is without them";
    notes.push_back(note.str());
}

/// Of a vessel with what water is in her.
std::optional<double> RunTally::exact_draft(const PreparedBody& body, const Pose& pose,
                                            std::optional<double> waterline) const
{
    const double density = scene_.fluid.density;
    const TriangleMesh hull = hull_of(body.mesh, scene_.dimensions);
    const auto level = waterline ? WettedSurface(hull, pose).level_of_basins(*waterline) : std::nullopt;
    if (!level) return equilibrium_draft(body.mesh, pose.orientation, body.mass / density);
    const BasinQuery basin(hull, pose, *level);
    const FluidState& fluid = world_.fluid().fluid();
    const auto aboard = std::count_if(fluid.position.begin(), fluid.position.end(), [&](const Vec4& position) {
        return basin.holds(position.head<3>().cast<double>());
    });
    const double mass = body.mass + fluid.particle_mass * static_cast<double>(aboard);
    return vessel_draft(hull, pose, *waterline, mass / density);
}

JointReport RunTally::report_joint(std::size_t k) const
{
    using Type = SceneJoint::Type;
    const Type type = scene_.joints[k].type;
    const double position = world_.joint(k).position;
    JointReport report;
    report.name = scene_.joints[k].name;
    report.type = type == Type::hinge ? "hinge" : type == Type::slider ? "slider" : "ball";
    if (type == Type::slider)
        report.position = position;
    else
        report.angle_deg = position * kDegrees;
    report.force_mean = joints_[k].force.mean().value_or(Vec3d::Zero());
    report.torque_mean = joints_[k].torque.mean().value_or(Vec3d::Zero());
    return report;
}

Vec3d rotation_vector(const Quatd& rotation)
{
    const Eigen::AngleAxisd turn(rotation);
    const double angle = turn.angle() > std::numbers::pi ? turn.angle() - 2.0 * std::numbers::pi : turn.angle();
    return angle * turn.axis();
}

} // namespace flotsam::scene
