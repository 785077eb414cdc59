#pragma once

#include "flotsam/scene/run_report.hpp"
#include "flotsam/scene/scene_file.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace flotsam {

struct RunOptions {
    std::filesystem::path out; ///< directory of results; empty: no files
    int threads = 0;           ///< 0: all the machine has
};

struct RunProgress {
    double time = 0.0, duration = 0.0; ///< simulated [s]
    double wall_seconds = 0.0;         ///< since the first step
    std::int64_t steps = 0;
};

/// Is told how a run goes on.
class RunObserver {
  public:
    virtual ~RunObserver() = default;
    /// Before on_start, while the water of a scene that starts at rest is brought there: after each round.
    virtual void on_settle(const SettleProgress&) {}
    /// Once, before the first step.
    virtual void on_start(std::size_t fluid_particles, std::size_t boundary_samples,
                          const std::vector<std::string>& notes) = 0;
    /// After each step.
    virtual void on_step(const RunProgress& progress) = 0;
};

/// Does nothing with what it is told.
class SilentObserver final : public RunObserver {
  public:
    void on_start(std::size_t, std::size_t, const std::vector<std::string>&) override {}
    void on_step(const RunProgress&) override {}
};

/// The physics came apart, or results could not be written; what() is one sentence.
class RunFailure : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Checks a scene, builds the fluid and its Bullet world, runs it and records it: report.json, history.csv, and what
/// the scene's output asks for. Frames come at exact times; one at the start, one at the end. VTK frames and pictures
/// are each made by a thread of their own from copies of the state, a few at most behind the run; when this returns or
/// throws, all are written that the run got to.
///
/// Throws InputError as check_scene does, before the directory of an older run is touched. Throws RunFailure for a
/// state that is not finite and for results that cannot be written; what was recorded until then stays in
/// `OUT.partial`.
RunReport run_scene(const SceneFile& scene, const RunOptions& options, RunObserver& observer);

} // namespace flotsam
