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

/// As it is turned in the file.
bool has_hollow(const FloatingBody& body)
{
    return WettedSurface(body.mesh, Pose{}).level_of_basins(lowest_point(body.mesh, Pose{})).has_value();
}

/// As she is turned in the file, her hollow dry; nothing for what has none, sinks or founders.
std::optional<Flotation> as_vessel(const FloatingBody& body)
{
    if (!has_hollow(body)) return std::nullopt;
    return vessel_flotation(body, Quatd::Identity());
}

[[noreturn]] void refuse_as_sinking(const HydrostaticsRequest& request, const FloatingBody& body, double volume)
{
    std::ostringstream sentence;
    sentence << request.mesh.string() << ": it sinks: ";
    if (has_hollow(body)) sentence << "water comes over the rim of its hollow, and then ";
    sentence << "its " << body.mass << " kg in " << volume << " m^3 are " << body.mass / volume
             << " kg/m^3, and the water has " << body.water_density << " kg/m^3; what floats must be lighter";
    throw InputError(sentence.str());
}

/// How a vessel floats; nothing for other bodies.
bool report_vessel(const HydrostaticsRequest& request, const FloatingBody& body, HydrostaticsReport& report)
{
    const auto afloat = as_vessel(body);
    if (!afloat) return false;
    report.is_vessel = true;
    report.as_modelled = *afloat;
    report.notes.push_back("it has a hollow, which is dry as it is turned in the file and in the righting arms; the "
                           "stable poses are those with the hollow open to the water");
    if (auto open = stable_poses(body))
        report.stable = std::move(*open);
    else
        report.notes.push_back("with its hollow open to the water it sinks: there is no such pose");
    if (!request.heel) return true;
    VesselArms arms = vessel_righting_arms(body, Quatd::Identity(), radians(*request.heel));
    report.righting_arms = std::move(arms.arms);
    report.flooding_heel = arms.flooding_heel;
    for (const std::optional<double>& heel : arms.flooding_heel) {
        if (!heel) continue;
        std::ostringstream note;
        note.precision(4);
        note << "at a heel of " << *heel * 180.0 / std::numbers::pi
             << " degrees water comes over its rim: there the righting arms end";
        report.notes.push_back(note.str());
    }
    return true;
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
    body.mesh = outer_surface(mesh);
    body.mass = request.mass ? *request.mass : *request.density * solid.volume;
    body.center_of_mass = request.center_of_mass.value_or(solid.center_of_mass);
    body.water_density = request.water_density;

    const double room = mass_properties(body.mesh).volume;
    refuse_if_massless(request, body, room);
    HydrostaticsReport report;
    report.version = kVersion;
    report.mesh = request.mesh;
    report.notes = check.notes;
    if (body.mesh.triangles.size() < mesh.triangles.size())
        report.notes.push_back("no water comes into its cavities: they displace water, too");
    report.triangles = mesh.triangles.size();
    report.volume = solid.volume;
    report.mass = body.mass;
    report.water_density = body.water_density;
    report.center_of_mass = body.center_of_mass;
    if (report_vessel(request, body, report)) return report;
    const auto as_modelled = flotation(body, Quatd::Identity());
    if (!as_modelled) refuse_as_sinking(request, body, room);
    report.as_modelled = *as_modelled;
    report.stable = *stable_poses(body);
    if (request.heel) report.righting_arms = righting_arms(body, Quatd::Identity(), radians(*request.heel));
    return report;
}

} // namespace flotsam
