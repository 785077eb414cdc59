#include "flotsam/scene/run_report.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

namespace flotsam {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN: null.
Json number(double value)
{
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json number(const std::optional<double>& value)
{
    return value ? number(*value) : Json(nullptr);
}
Json vector(const Vec3d& v)
{
    return Json::array({number(v.x()), number(v.y()), number(v.z())});
}
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

Json ledger_json(const MomentumLedger& ledger)
{
    Json forces = Json::array();
    for (const Vec3d& force : ledger.wall_force_mean) forces.push_back(vector(force));
    return {{"gravity_impulse", vector(ledger.gravity_impulse)},
            {"wall_impulse", vector(ledger.wall_impulse)},
            {"body_impulse", vector(ledger.body_impulse)},
            {"guard_impulse", vector(ledger.guard_impulse)},
            {"fluid_momentum_start", vector(ledger.fluid_momentum_start)},
            {"fluid_momentum_end", vector(ledger.fluid_momentum_end)},
            {"momentum_error_relative", number(ledger.momentum_error_relative)},
            {"wall_force_mean", forces}};
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
    Json json = {{"version", report.version},
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
                 {"unconverged_steps", report.unconverged_steps},
                 {"compression", mean_and_max(report.compression)},
                 {"leaked", report.leaked},
                 {"leaks_stopped", report.leaks_stopped},
                 {"peak_memory_bytes", report.peak_memory_bytes},
                 {"state_hash", hexadecimal(report.state_hash)},
                 {"ledger", ledger_json(report.ledger)},
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
