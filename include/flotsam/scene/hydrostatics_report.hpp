#pragma once

#include "flotsam/geometry/equilibrium_poses.hpp"
#include "flotsam/geometry/vessel_flotation.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flotsam {

/// Heel angles from start to end [deg]: at most 10 000.
struct HeelRange {
    double start_deg = 0.0;
    double step_deg = 5.0; ///< > 0
    double end_deg = 60.0; ///< >= start
    static constexpr int kMostRows = 10000;

    /// How many angles; 0 where that is none, too many or not a number.
    [[nodiscard]] int rows() const;
};

/// Which body is to be set afloat. `density` or `mass`, never both.
struct HydrostaticsRequest {
    std::filesystem::path mesh;                         ///< closed
    double scale = 1.0;                                 ///< metres per unit of the file, > 0
    std::optional<double> density = std::nullopt;       ///< of the body as a whole [kg/m^3], > 0
    std::optional<double> mass = std::nullopt;          ///< [kg], > 0
    double water_density = 1000.0;                      ///< [kg/m^3], > 0
    std::optional<Vec3d> center_of_mass = std::nullopt; ///< mesh frame [m]; nothing: of the uniform solid
    std::optional<HeelRange> heel = std::nullopt;       ///< of the curve of righting arms; nothing: no curve
};

/// A body's exact hydrostatics, in water of 9.81 m/s^2. A vessel that floats as she is turned in the file has her
/// hollow dry there and in her righting arms, which end where water comes over her rim; her stable poses are those with
/// the hollow open to the water, and none where she sinks then.
struct HydrostaticsReport {
    std::string version; ///< of flotsam
    std::filesystem::path mesh;
    std::vector<std::string> notes; ///< what was repaired in the mesh, and of its hollow; a sentence each
    std::size_t triangles = 0;
    double volume = 0.0;                  ///< [m^3]
    double mass = 0.0;                    ///< [kg]
    double water_density = 0.0;           ///< [kg/m^3]
    Vec3d center_of_mass = Vec3d::Zero(); ///< mesh frame [m]
    bool is_vessel = false;
    Flotation as_modelled; ///< at its draft, not turned from how the file has it
    EquilibriumPoses stable;
    std::vector<RightingArm> righting_arms;             ///< about x from how the file has it
    std::array<std::optional<double>, 2> flooding_heel; ///< of a vessel, as VesselArms has it [rad]
};

/// Loads and checks the mesh and computes everything that is asked for. Throws InputError for a mesh that is refused
/// (see check_mesh_file) and for a body that sinks; NoEquilibrium; std::invalid_argument for a request that is out of
/// bounds.
[[nodiscard]] HydrostaticsReport report_hydrostatics(const HydrostaticsRequest& request);

/// All numbers of a report.
[[nodiscard]] std::string report_as_json(const HydrostaticsReport& report);

/// Writes hydrostatics.json and poses.csv and, where there is a curve, righting_arm.csv and righting_arm.png into a new
/// directory, or in place of an older output (see OutputDirectory). Returns why the picture could not be drawn, one
/// sentence, or nothing; everything else is there all the same. Throws InputError and OutputError as OutputDirectory
/// does.
[[nodiscard]] std::string write_hydrostatics(const HydrostaticsReport& report, const std::filesystem::path& directory);

} // namespace flotsam
