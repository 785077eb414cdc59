#pragma once

#include "flotsam/world/step_report.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace flotsam {

/// Where a body ended, and means over the last quarter of the run. A body's position is its centre of mass; its
/// rotation is that of the scene's shape. Water lines and drafts are measured where gravity points down the z axis.
struct BodyReport {
    std::string name;
    std::optional<double> mass;         ///< [kg]
    double volume = 0.0;                ///< [m^3] (2-D: per metre)
    Vec3d position = Vec3d::Zero();     ///< [m]
    Vec3d rotation_deg = Vec3d::Zero(); ///< rotation vector
    Vec3d velocity = Vec3d::Zero();     ///< [m/s]
    double tilt_deg = 0.0;              ///< between the shape's z axis and the world's
    std::optional<double> waterline;    ///< mean height of the undisturbed water that it is in [m]
    std::optional<double> draft;        ///< mean of waterline - lowest point [m]
    /// Of the exact mesh in the pose it ended in, a vessel with the water that is in her [m]; nothing: it sinks.
    std::optional<double> exact_draft;
    Vec3d force_fluid_mean = Vec3d::Zero();  ///< [N]
    Vec3d torque_fluid_mean = Vec3d::Zero(); ///< about the centre of mass [N m]
};

/// Where a joint ended, and means over the last quarter of the run of what `b` (or the world) puts on `a` through it, a
/// motor included.
struct JointReport {
    std::string name;
    std::string type;                  ///< "hinge", "slider" or "ball"
    std::optional<double> angle_deg;   ///< of a hinge, whole turns included; of a ball in 3-D that turned, in [0, 180]
    std::optional<double> position;    ///< of a slider [m]
    Vec3d force_mean = Vec3d::Zero();  ///< [N]
    Vec3d torque_mean = Vec3d::Zero(); ///< about the joint's point, which goes with `a` [N m]
};

struct ProbeReport {
    std::string name;
    std::optional<double> mean; ///< over the last quarter; nothing where it met no fluid
    std::optional<double> last;
};

struct MeanAndMax {
    double mean = 0.0, max = 0.0;
};

/// What a run did; report.json holds the same.
struct RunReport {
    std::string version;
    std::string scene; ///< the scene file
    int threads = 0;
    std::size_t fluid_particles = 0, boundary_samples = 0;
    double particle_spacing = 0.0; ///< [m]
    double rest_density = 0.0;     ///< [kg/m^3]
    double simulated_seconds = 0.0;
    std::int64_t steps = 0;
    double wall_seconds = 0.0; ///< of stepping, and of waiting for what is written
    StageSeconds stage_seconds;
    MeanAndMax iterations;      ///< per step, of all its solves
    MeanAndMax coupling_rounds; ///< of the pressure solve per step, until joints and contacts held and yielded with it
    MeanAndMax disagreement;    ///< velocity that Bullet gave a body beside what the fluid believed in, per step [m/s]
    std::int64_t unconverged_steps = 0;
    MeanAndMax compression;         ///< mean over the last quarter of each step's mean; maximum of the run
    int leaked = 0;                 ///< most particles outside at one time
    std::int64_t leaks_stopped = 0; ///< by the wall guard
    std::int64_t peak_memory_bytes = 0;
    std::uint64_t state_hash = 0;
    Ledger ledger;                      ///< of the whole run
    std::vector<Vec3d> wall_force_mean; ///< per wall, over the last quarter [N]
    std::vector<BodyReport> bodies;
    std::vector<JointReport> joints;
    std::vector<ProbeReport> probes;
    std::vector<std::string> notes; ///< what was cut or repaired
    std::string failure;            ///< why the run stopped early; empty: it did not
};

/// The text of report.json.
[[nodiscard]] std::string report_as_json(const RunReport& report);

} // namespace flotsam
