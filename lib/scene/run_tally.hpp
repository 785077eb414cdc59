#pragma once

#include "flotsam/scene/run_report.hpp"
#include "scene/scene_world.hpp"

#include <optional>
#include <vector>

namespace flotsam::scene {

/// Mean over time; nothing before anything was added.
template <class Value>
class TimeMean {
  public:
    explicit TimeMean(Value zero) : sum_(zero) {}
    void add(const Value& value, double dt)
    {
        sum_ += value * dt;
        seconds_ += dt;
    }
    [[nodiscard]] std::optional<Value> mean() const
    {
        return seconds_ > 0.0 ? std::optional<Value>(sum_ * (1.0 / seconds_)) : std::nullopt;
    }
    [[nodiscard]] double seconds() const { return seconds_; }

  private:
    Value sum_;
    double seconds_ = 0.0;
};

/// Pressure or level at a probe now; nothing where a level line meets no fluid.
[[nodiscard]] std::optional<double> read_probe(const FluidWorld& fluid, const SceneProbe& probe);

/// Axis times angle [rad], the angle in [0, pi].
[[nodiscard]] Vec3d rotation_vector(const Quatd& rotation);

/// Sums up the steps of a run: what report.json says of it.
class RunTally {
  public:
    RunTally(const SceneFile& scene, const PreparedScene& prepared, const SceneWorld& world);

    void add(const StepReport& step);
    /// The whole report, of where the run is now.
    [[nodiscard]] RunReport report() const;
    [[nodiscard]] std::int64_t steps() const { return steps_; }

  private:
    struct BodyMeans {
        TimeMean<Vec3d> force{Vec3d::Zero()}, torque{Vec3d::Zero()};
        TimeMean<double> waterline{0.0}, draft{0.0};
        Vec3d velocity_before = Vec3d::Zero(); ///< the last quarter of the run [m/s]
    };
    struct JointMeans {
        TimeMean<Vec3d> force{Vec3d::Zero()}, torque{Vec3d::Zero()};
    };
    void add_totals(const StepReport& step);
    void add_last_quarter(const StepReport& step);
    void measure_drafts(double dt);
    void report_fluid(RunReport& report) const;
    [[nodiscard]] BodyReport report_body(std::size_t k) const;
    void note_loads(std::size_t k, const BodyReport& body, std::vector<std::string>& notes) const;
    [[nodiscard]] std::optional<double> exact_draft(const PreparedBody& body, const Pose& pose,
                                                    std::optional<double> waterline) const;
    [[nodiscard]] JointReport report_joint(std::size_t k) const;

    const SceneFile& scene_;
    const PreparedScene& prepared_;
    const SceneWorld& world_;
    std::int64_t steps_ = 0, unconverged_ = 0, leaks_stopped_ = 0, iterations_ = 0, rounds_ = 0;
    int most_iterations_ = 0, most_rounds_ = 0, leaked_ = 0, fallen_ = 0;
    TimeMean<double> disagreement_{0.0};
    double most_disagreement_ = 0.0;
    double compression_max_ = 0.0, next_draft_ = 0.0;
    StageSeconds seconds_;
    TimeMean<double> compression_{0.0};
    std::vector<TimeMean<Vec3d>> wall_forces_;
    std::vector<TimeMean<double>> probes_;
    std::vector<BodyMeans> bodies_;
    std::vector<JointMeans> joints_;
};

} // namespace flotsam::scene
