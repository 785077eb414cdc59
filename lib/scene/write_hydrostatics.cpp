#include "flotsam/io/csv.hpp"
#include "flotsam/io/output_directory.hpp"
#include "flotsam/io/output_error.hpp"
#include "flotsam/io/plot.hpp"
#include "flotsam/scene/hydrostatics_report.hpp"
#include "scene/json_numbers.hpp"

#include <array>
#include <numbers>

namespace flotsam {
namespace {

namespace fs = std::filesystem;
using scene::Json;
using scene::number;
using scene::vector;

constexpr double kDegrees = 180.0 / std::numbers::pi;

Json heights_json(const MetacentricHeights& heights)
{
    return {{"heel", number(heights.heel)},
            {"trim", number(heights.trim)},
            {"least", number(heights.least)},
            {"greatest", number(heights.greatest)},
            {"least_axis_deg", number(heights.least_axis * kDegrees)}};
}

Json waterplane_json(const Waterplane& plane)
{
    const Eigen::Matrix2d& moment = plane.second_moment;
    return {
        {"area", number(plane.area)},
        {"centroid", Json::array({number(plane.centroid.x()), number(plane.centroid.y())})},
        {"second_moment", {{"xx", number(moment(0, 0))}, {"xy", number(moment(0, 1))}, {"yy", number(moment(1, 1))}}}};
}

/// Heights above the lowest point; places in the world with the water at z = 0 and the centre of mass at x = y = 0.
Json flotation_json(const Flotation& afloat)
{
    return {{"draft", number(afloat.draft)},
            {"displaced_volume", number(afloat.submerged.volume)},
            {"center_of_mass", vector(afloat.center_of_mass)},
            {"center_of_buoyancy", vector(afloat.submerged.center_of_buoyancy)},
            {"keel_to_center_of_mass", number(afloat.draft + afloat.center_of_mass.z())},
            {"keel_to_center_of_buoyancy", number(afloat.draft + afloat.submerged.center_of_buoyancy.z())},
            {"waterplane", waterplane_json(afloat.plane)},
            {"metacentric_heights", heights_json(afloat.metacentric_heights)},
            {"righting_arms", Json::array({number(afloat.righting_arms.x()), number(afloat.righting_arms.y())})},
            {"energy", number(afloat.energy)}};
}

Json pose_json(const EquilibriumPose& pose, double lowest_energy)
{
    const Quatd& q = pose.flotation.pose.orientation;
    return {{"heel_deg", number(pose.heel_deg)},
            {"trim_deg", number(pose.trim_deg)},
            {"rotation_deg", vector(pose.rotation_deg)},
            {"quaternion_wxyz", Json::array({number(q.w()), number(q.x()), number(q.y()), number(q.z())})},
            {"position", vector(pose.flotation.pose.position)},
            {"energy_above_lowest", number(pose.flotation.energy - lowest_energy)},
            {"neutral_directions", pose.neutral_directions},
            {"residual", number(pose.residual)},
            {"flotation", flotation_json(pose.flotation)}};
}

Json arm_json(const RightingArm& arm)
{
    return {{"heel_deg", number(arm.heel * kDegrees)},
            {"gz", number(arm.arm)},
            {"righting_moment", number(arm.moment)},
            {"draft", number(arm.draft)},
            {"energy", number(arm.energy)}};
}

void write_poses(const fs::path& file, const EquilibriumPoses& stable)
{
    const std::vector<std::string> columns = {"heel_deg",   "trim_deg",           "draft_m", "energy_above_lowest_J",
                                              "gm_least_m", "gm_greatest_m",      "rx_deg",  "ry_deg",
                                              "rz_deg",     "neutral_directions", "residual"};
    CsvWriter table(file, columns);
    for (const EquilibriumPose& pose : stable.poses) {
        const Flotation& afloat = pose.flotation;
        table.row(std::array{pose.heel_deg, pose.trim_deg, afloat.draft,
                             afloat.energy - stable.poses.front().flotation.energy, afloat.metacentric_heights.least,
                             afloat.metacentric_heights.greatest, pose.rotation_deg.x(), pose.rotation_deg.y(),
                             pose.rotation_deg.z(), static_cast<double>(pose.neutral_directions), pose.residual});
    }
    table.close();
}

void write_arms(const fs::path& file, const std::vector<RightingArm>& arms)
{
    const std::vector<std::string> columns = {"heel_deg", "gz_m", "draft_m", "righting_moment_N_m", "energy_J"};
    CsvWriter table(file, columns);
    for (const RightingArm& arm : arms)
        table.row(std::array{arm.heel * kDegrees, arm.arm, arm.draft, arm.moment, arm.energy});
    table.close();
}

Plot plot_of(const HydrostaticsReport& report)
{
    PlotSeries curve{PlotSeries::Style::line, "GZ", {}, {}, {}};
    for (const RightingArm& arm : report.righting_arms) {
        curve.x.push_back(arm.heel * kDegrees);
        curve.y.push_back(arm.arm);
    }
    if (curve.x.size() == 1) curve.style = PlotSeries::Style::points;
    Plot plot;
    plot.title = "Righting arm of " + report.mesh.filename().string();
    plot.x_label = "heel [deg]";
    plot.y_label = "righting arm GZ [m]";
    plot.series.push_back(std::move(curve));
    return plot;
}

} // namespace

std::string report_as_json(const HydrostaticsReport& report)
{
    Json json = {{"version", report.version},
                 {"mesh", report.mesh.string()},
                 {"notes", report.notes},
                 {"triangles", report.triangles},
                 {"volume", number(report.volume)},
                 {"mass", number(report.mass)},
                 {"density", number(report.mass / report.volume)},
                 {"water_density", number(report.water_density)},
                 {"center_of_mass", vector(report.center_of_mass)},
                 {"vessel", report.is_vessel},
                 {"as_modelled", flotation_json(report.as_modelled)},
                 {"starts", report.stable.starts},
                 {"unconverged_starts", report.stable.unconverged_starts},
                 {"stable_poses", Json::array()},
                 {"righting_arms", Json::array()},
                 {"flooding_heel_deg", Json::array()}};
    for (const EquilibriumPose& pose : report.stable.poses)
        json["stable_poses"].push_back(pose_json(pose, report.stable.poses.front().flotation.energy));
    for (const RightingArm& arm : report.righting_arms) json["righting_arms"].push_back(arm_json(arm));
    for (const std::optional<double>& heel : report.flooding_heel)
        json["flooding_heel_deg"].push_back(heel ? number(*heel * kDegrees) : Json());
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string write_hydrostatics(const HydrostaticsReport& report, const fs::path& directory)
{
    OutputDirectory out(directory, OutputKind::hydrostatics);
    write_text_atomically(out.path() / "hydrostatics.json", report_as_json(report));
    write_poses(out.path() / "poses.csv", report.stable);
    if (!report.righting_arms.empty()) write_arms(out.path() / "righting_arm.csv", report.righting_arms);
    out.commit();
    if (report.righting_arms.empty()) return {};
    try {
        write_plot(out.path() / "righting_arm.png", plot_of(report));
        return {};
    } catch (const OutputError& error) {
        return error.what();
    }
}

} // namespace flotsam
