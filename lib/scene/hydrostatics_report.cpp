#include "flotsam/scene/hydrostatics_report.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/hydrostatics.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/version.hpp"
#include "geometry/wetted_surface.hpp"
#include "scene/solid_file.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

namespace flotsam {
namespace {

bool is_positive(double value)
{
    return value > 0.0 && std::isfinite(value);
}

void require_valid(const HydrostaticsRequest& request)
{
    require(request.density.has_value() != request.mass.has_value(), "a body must have a density or a mass, not both");
    require(is_positive(request.density.value_or(1.0)), "density must be > 0 kg/m^3 and finite",
            request.density.value_or(0.0));
    require(is_positive(request.mass.value_or(1.0)), "mass must be > 0 kg and finite", request.mass.value_or(0.0));
    require(is_positive(request.water_density), "water_density must be > 0 kg/m^3 and finite", request.water_density);
    require(is_positive(request.scale), "scale must be > 0 m and finite", request.scale);
    require(!request.center_of_mass || request.center_of_mass->allFinite(), "center_of_mass must be finite [m]");
    require(!request.heel || request.heel->rows() > 0,
            "heel must have a step > 0, an end >= its start and at most 10000 rows");
}

std::vector<double> radians(const HeelRange& range)
{
    std::vector<double> angles;
    for (int row = 0; row < range.rows(); ++row)
        angles.push_back((range.start_deg + row * range.step_deg) * std::numbers::pi / 180.0);
    return angles;
}

/// As she is turned in the file, her hollow dry; nothing for what has none or sinks.
std::optional<double> draft_as_vessel(const FloatingBody& body)
{
    const double low = lowest_point(body.mesh, Pose{});
    const auto draft = vessel_draft(body.mesh, Pose{}, low, body.mass / body.water_density);
    if (!draft || !WettedSurface(body.mesh, Pose{}).has_basin(low + *draft)) return std::nullopt;
    return draft;
}

[[noreturn]] void refuse_as_sinking(const HydrostaticsRequest& request, const FloatingBody& body, double volume)
{
    const auto as_vessel = draft_as_vessel(body);
    std::ostringstream sentence;
    sentence << request.mesh.string() << ": it sinks: its " << body.mass << " kg in " << volume << " m^3 are "
             << body.mass / volume << " kg/m^3, and the water has " << body.water_density
             << " kg/m^3; what floats must be lighter";
    if (as_vessel)
        sentence << " (turned as in the file and with its hollow dry it floats, with a draft of " << *as_vessel
                 << " m: a run has that)";
    throw InputError(sentence.str());
}

/// Poses of what has next to no mass are lost in rounding.
void refuse_if_massless(const HydrostaticsRequest& request, const FloatingBody& body, double volume)
{
    constexpr double kLightest = 1e-9; // of the water's density
    const double displaced = body.water_density * volume;
    if (body.mass >= kLightest * displaced) return;
    std::ostringstream sentence;
    sentence << request.mesh.string() << ": its mass of " << body.mass << " kg must be at least " << kLightest
             << " of the " << displaced << " kg of water that it has room for";
    throw InputError(sentence.str());
}

} // namespace

int HeelRange::rows() const
{
    if (!(step_deg > 0.0 && end_deg >= start_deg && std::isfinite(end_deg - start_deg))) return 0;
    const double rows = std::floor((end_deg - start_deg) / step_deg + 1e-9) + 1.0;
    return rows <= kMostRows ? static_cast<int>(rows) : 0;
}

HydrostaticsReport report_hydrostatics(const HydrostaticsRequest& request)
{
    require_valid(request);
    const auto [mesh, check] = scene::read_solid(request.mesh, {.scale = request.scale});
    const MassProperties solid = mass_properties(mesh);
    FloatingBody body;
    body.mesh = mesh;
    body.mass = request.mass ? *request.mass : *request.density * solid.volume;
    body.center_of_mass = request.center_of_mass.value_or(solid.center_of_mass);
    body.water_density = request.water_density;

    refuse_if_massless(request, body, solid.volume);
    const auto as_modelled = flotation(body, Quatd::Identity());
    if (!as_modelled) refuse_as_sinking(request, body, solid.volume);
    HydrostaticsReport report;
    report.version = kVersion;
    report.mesh = request.mesh;
    report.notes = check.notes;
    report.triangles = mesh.triangles.size();
    report.volume = solid.volume;
    report.mass = body.mass;
    report.water_density = body.water_density;
    report.center_of_mass = body.center_of_mass;
    report.as_modelled = *as_modelled;
    if (const auto as_vessel = draft_as_vessel(body)) {
        std::ostringstream note;
        note << "it has a hollow: dry, and turned as in the file, its draft is " << *as_vessel
             << " m; what follows is with the hollow open to the water";
        report.notes.push_back(note.str());
    }
    report.stable = *stable_poses(body);
    if (request.heel) report.righting_arms = righting_arms(body, Quatd::Identity(), radians(*request.heel));
    return report;
}

} // namespace flotsam
