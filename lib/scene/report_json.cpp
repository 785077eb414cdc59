#include "flotsam/scene/run_report.hpp"

#include "scene/json_numbers.hpp"

#include <sstream>

namespace flotsam {
namespace {

using scene::Json;
using scene::number;
using scene::vector;

Json mean_and_max(const MeanAndMax& value)
{
    return {{"mean", number(value.mean)}, {"max", number(value.max)}};
}

std::string hexadecimal(std::uint64_t value)
{
    std::ostringstream text;
    text << std::hex;
    text.width(16);
    text.fill('0');
    text << value;
    return text.str();
}

Json seconds_json(const StageSeconds& s)
{
    return {{"bodies", s.bodies},     {"neighbours", s.neighbours}, {"density", s.density}, {"forces", s.forces},
            {"pressure", s.pressure}, {"advance", s.advance},       {"walls", s.walls}};
}

Json by_cause(const ByCause<double>& value)
{
    return {{"pressure", number(value.pressure)},
            {"viscous", number(value.viscous)},
            {"packing", number(value.packing)},
            {"guard", number(value.guard)}};
}
Json by_cause(const ByCause<Wrench>& value, Vec3d Wrench::*part)
{
    return {{"pressure", vector(value.pressure.*part)},
            {"viscous", vector(value.viscous.*part)},
            {"packing", vector(value.packing.*part)},
            {"guard", vector(value.guard.*part)}};
}

/// What is left over, by the largest of the terms.
double relative(double error, double scale)
{
    return scale > 0.0 ? std::abs(error) / scale : 0.0;
}

Json angular_json(const Ledger& ledger)
{
    return {{"start", vector(ledger.start.angular_momentum)},
            {"end", vector(ledger.end.angular_momentum)},
            {"gravity", vector(ledger.gravity.angular)},
            {"walls", by_cause(ledger.walls, &Wrench::angular)},
            {"bodies", by_cause(ledger.bodies, &Wrench::angular)},
            {"shift", vector(ledger.shift)},
            {"removed", vector(ledger.removed.angular_momentum)},
            {"error_relative",
             number(relative(ledger.errors().angular_momentum.norm(), ledger.scales().angular_momentum))}};
}

Json energy_json(const Ledger& ledger)
{
    const EnergyLedger& energy = ledger.energy;
    return {{"kinetic_start", number(ledger.start.kinetic)},
            {"kinetic_end", number(ledger.end.kinetic)},
            {"potential_start", number(ledger.start.potential)},
            {"potential_end", number(ledger.end.potential)},
            {"gravity", number(energy.gravity)},
            {"walls", by_cause(energy.walls)},
            {"bodies", by_cause(energy.bodies)},
            {"viscous", number(energy.viscous)},
            {"compression", number(energy.compression)},
            {"guard", number(energy.guard)},
            {"shift", number(energy.shift)},
            {"integration", number(energy.integration)},
            {"removed", number(ledger.removed.energy())},
            {"error_relative", number(relative(ledger.errors().energy, ledger.scales().energy))}};
}

Json volume_json(const Ledger& ledger)
{
    return {{"start", number(ledger.start.volume)},
            {"end", number(ledger.end.volume)},
            {"removed", number(ledger.removed.volume)},
            {"compressed", number(ledger.compressed)},
            {"error_relative", number(relative(ledger.errors().volume, ledger.start.volume))}};
}

Json ledger_json(const Ledger& ledger, const std::vector<Vec3d>& wall_force_mean)
{
    Json forces = Json::array();
    for (const Vec3d& force : wall_force_mean) forces.push_back(vector(force));
    return {{"gravity_impulse", vector(ledger.gravity.linear)},
            {"wall_impulse", vector(ledger.walls.total().linear)},
            {"body_impulse", vector(ledger.bodies.total().linear)},
            {"guard_impulse", vector(ledger.walls.guard.linear + ledger.bodies.guard.linear)},
            {"fluid_momentum_start", vector(ledger.start.momentum)},
            {"fluid_momentum_end", vector(ledger.end.momentum)},
            {"momentum_error_relative", number(relative(ledger.errors().momentum.norm(), ledger.scales().momentum))},
            {"wall_force_mean", forces},
            {"momentum",
             {{"walls", by_cause(ledger.walls, &Wrench::linear)},
              {"bodies", by_cause(ledger.bodies, &Wrench::linear)},
              {"removed", vector(ledger.removed.momentum)}}},
            {"angular_momentum", angular_json(ledger)},
            {"energy", energy_json(ledger)},
            {"volume", volume_json(ledger)}};
}

Json body_json(const BodyReport& body)
{
    return {{"name", body.name},
            {"mass", number(body.mass)},
            {"volume", number(body.volume)},
            {"position", vector(body.position)},
            {"rotation_deg", vector(body.rotation_deg)},
            {"velocity", vector(body.velocity)},
            {"tilt_deg", number(body.tilt_deg)},
            {"waterline", number(body.waterline)},
            {"draft", number(body.draft)},
            {"exact_draft", number(body.exact_draft)},
            {"force_fluid_mean", vector(body.force_fluid_mean)},
            {"torque_fluid_mean", vector(body.torque_fluid_mean)}};
}

Json joint_json(const JointReport& joint)
{
    Json json = {{"name", joint.name}, {"type", joint.type}};
    if (joint.angle_deg) json["angle_deg"] = number(joint.angle_deg);
    if (joint.position) json["position"] = number(joint.position);
    json["force_mean"] = vector(joint.force_mean);
    json["torque_mean"] = vector(joint.torque_mean);
    return json;
}

} // namespace

std::string report_as_json(const RunReport& report)
{
    Json json = {
        {"version", report.version},
        {"scene", report.scene},
        {"threads", report.threads},
        {"particles", {{"fluid", report.fluid_particles}, {"boundary", report.boundary_samples}}},
        {"particle_spacing", report.particle_spacing},
        {"rest_density", report.rest_density},
        {"simulated_seconds", report.simulated_seconds},
        {"steps", report.steps},
        {"wall_seconds", report.wall_seconds},
        {"stage_seconds", seconds_json(report.stage_seconds)},
        {"iterations", mean_and_max(report.iterations)},
        {"coupling",
         {{"rounds", mean_and_max(report.coupling_rounds)}, {"disagreement", mean_and_max(report.disagreement)}}},
        {"unconverged_steps", report.unconverged_steps},
        {"compression", mean_and_max(report.compression)},
        {"leaked", report.leaked},
        {"leaks_stopped", report.leaks_stopped},
        {"peak_memory_bytes", report.peak_memory_bytes},
        {"state_hash", hexadecimal(report.state_hash)},
        {"ledger", ledger_json(report.ledger, report.wall_force_mean)},
        {"bodies", Json::array()},
        {"joints", Json::array()},
        {"probes", Json::array()},
        {"notes", report.notes}};
    for (const BodyReport& body : report.bodies) json["bodies"].push_back(body_json(body));
    for (const JointReport& joint : report.joints) json["joints"].push_back(joint_json(joint));
    for (const ProbeReport& probe : report.probes)
        json["probes"].push_back({{"name", probe.name}, {"mean", number(probe.mean)}, {"last", number(probe.last)}});
    if (!report.failure.empty()) json["failure"] = report.failure;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace flotsam
