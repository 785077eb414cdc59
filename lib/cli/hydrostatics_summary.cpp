#include "cli/hydrostatics_summary.hpp"

#include "cli/table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

namespace flotsam::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::size_t kMostRows = 40; ///< of a curve that is printed; the file has all

void print_body(std::ostream& out, const HydrostaticsReport& report)
{
    const Vec3d& center = report.center_of_mass;
    out << report.mesh.string() << ": " << report.triangles << " triangles\n";
    print_table(out, {{"volume [m^3]", significant(report.volume, 6)},
                      {"mass [kg]", significant(report.mass, 6)},
                      {"density [kg/m^3], of the water",
                       significant(report.mass / report.volume, 6) + ", " + significant(report.water_density, 6)},
                      {"centre of mass [m]",
                       fixed(center.x(), 4) + ", " + fixed(center.y(), 4) + ", " + fixed(center.z(), 4)}});
}

void print_as_modelled(std::ostream& out, const HydrostaticsReport& report)
{
    const Flotation& afloat = report.as_modelled;
    const MetacentricHeights& heights = afloat.metacentric_heights;
    out << "\nAfloat, turned as in the file and held there" << (report.is_vessel ? ", its hollow dry" : "") << ":\n";
    print_table(out, {{"draft [m]", fixed(afloat.draft, 5)},
                      {"displaced volume [m^3]", significant(afloat.submerged.volume, 6)},
                      {"lowest point to centre of buoyancy, KB [m]",
                       fixed(afloat.draft + afloat.submerged.center_of_buoyancy.z(), 5)},
                      {"lowest point to centre of mass, KG [m]", fixed(afloat.draft + afloat.center_of_mass.z(), 5)},
                      {"waterplane area [m^2]", significant(afloat.plane.area, 6)},
                      {"metacentric height GM about x (heel) [m]", fixed(heights.heel, 5)},
                      {"metacentric height GM about y (trim) [m]", fixed(heights.trim, 5)},
                      {"righting arms about x, y as it is [m]",
                       fixed(afloat.righting_arms.x(), 5) + ", " + fixed(afloat.righting_arms.y(), 5)}});
}

void print_poses(std::ostream& out, const HydrostaticsReport& report)
{
    const EquilibriumPoses& stable = report.stable;
    if (stable.poses.empty()) return;
    std::vector<Row> rows{{"pose", "heel [deg]", "trim [deg]", "draft [m]", "energy [J]", "least GM [m]", "stable"}};
    const auto stable_words = [](int neutral) {
        return neutral == 0 ? "yes" : neutral == 1 ? "neutral in one direction" : "neutral";
    };
    for (const EquilibriumPose& pose : stable.poses)
        rows.push_back({std::to_string(rows.size()), fixed(pose.heel_deg, 2), fixed(pose.trim_deg, 2),
                        fixed(pose.flotation.draft, 5),
                        significant(std::max(0.0, pose.flotation.energy - stable.poses.front().flotation.energy), 3),
                        fixed(pose.flotation.metacentric_heights.least, 5), stable_words(pose.neutral_directions)});
    out << "\nStable poses" << (report.is_vessel ? " with its hollow open to the water" : "")
        << ", energy above the lowest:\n";
    print_table(out, rows);
    if (stable.unconverged_starts > 0)
        out << "  note: " << stable.unconverged_starts << " of " << stable.starts << " searches did not come to rest\n";
}

void print_arms(std::ostream& out, const HydrostaticsReport& report)
{
    const std::vector<RightingArm>& arms = report.righting_arms;
    double largest = 0.0;
    for (const RightingArm& arm : arms) largest = std::max(largest, std::abs(arm.moment));
    const auto moment_words = [&](double moment) { // what is left by rounding is none
        return significant(std::abs(moment) > 1e-9 * largest ? moment : 0.0, 5);
    };
    out << "\nRighting arms" << (report.is_vessel ? ", its hollow dry" : "") << ":\n";
    std::vector<Row> rows{{"heel [deg]", "GZ [m]", "moment [N m]", "draft [m]"}};
    for (std::size_t k = 0; k < std::min(arms.size(), kMostRows); ++k)
        rows.push_back({fixed(arms[k].heel * kDegrees, 2), fixed(arms[k].arm, 5), moment_words(arms[k].moment),
                        fixed(arms[k].draft, 5)});
    print_table(out, rows);
    if (arms.size() > kMostRows) out << "  ... " << arms.size() << " rows in righting_arm.csv\n";
}

} // namespace

void print_hydrostatics(std::ostream& out, const HydrostaticsReport& report, const std::filesystem::path& directory)
{
    for (const std::string& note : report.notes) out << "note: " << note << "\n";
    print_body(out, report);
    print_as_modelled(out, report);
    print_poses(out, report);
    if (!report.righting_arms.empty()) print_arms(out, report);
    out << "\nIn " << directory.string() << ":\n";
    std::vector<Row> files{{"hydrostatics.json", "all of this in numbers"}, {"poses.csv", "the stable poses"}};
    for (const auto& [name, words] :
         {std::pair("righting_arm.csv", "the righting arms"), std::pair("righting_arm.png", "their curve")})
        if (std::filesystem::exists(directory / name)) files.push_back({name, words});
    for (const Row& file : files) out << "  " << file[0] << std::string(19 - file[0].size(), ' ') << file[1] << "\n";
}

} // namespace flotsam::cli
