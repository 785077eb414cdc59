#include "flotsam/scene/run_scene.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_error.hpp"
#include "flotsam/version.hpp"
#include "scene/recorder.hpp"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <sstream>

namespace flotsam {
namespace scene {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t peak_memory_bytes()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

std::string in_words(double value)
{
    std::ostringstream text;
    text.precision(3);
    text << value;
    return text.str();
}

/// Twice the speed of sound in water: nothing that is still a fluid of constant density is so fast.
constexpr double kFastest = 3000.0; // [m/s]

/// Throws RunFailure for a state that is no longer physics.
void refuse_broken_state(const StepReport& step, const SceneFile& scene, const SceneWorld& world)
{
    const std::string when = " at t = " + std::to_string(world.fluid().time()) + " s";
    if (!step.fluid_momentum.allFinite() || !(step.max_speed < kFastest))
        throw RunFailure(scene.file.string() + ": the fluid came apart" + when +
                         "; a smaller time_step.max or a tighter pressure.tolerance may help");
    for (std::size_t k = 0; k < world.body_count(); ++k) {
        const BodyNow now = world.body(k);
        const bool whole = now.pose.position.allFinite() && now.pose.orientation.coeffs().allFinite() &&
                           now.twist.linear.norm() < kFastest && now.twist.angular.allFinite();
        if (!whole)
            throw RunFailure(scene.file.string() + ": body \"" + scene.bodies[k].name +
                             "\" was thrown out of the world" + when + "; a smaller time_step.max may help");
    }
}

/// Everything that a run writes: rows of the history at once, frames and pictures in the background.
class Recorder {
  public:
    Recorder(const std::filesystem::path& directory, const SceneFile& scene, const PreparedScene& prepared,
             const SceneWorld& world, int threads)
        : history_(directory / "history.csv", scene)
    {
        if (scene.output.vtk) vtk_.emplace(directory, prepared, world);
        if (scene.output.pictures) pictures_.emplace(directory, scene, prepared, world, threads);
    }
    /// Throws what went wrong with an earlier frame, so that a run whose frames are far apart ends soon.
    void add_step(const SceneWorld& world, double dt)
    {
        check_frames();
        history_.add_step(world, dt);
    }
    void add_frame(int frame, bool last, const SceneFile& scene, const PreparedScene& prepared, const SceneWorld& world)
    {
        history_.write_row(scene, prepared, world);
        if (vtk_) vtk_->add(world);
        if (pictures_) pictures_->add(frame, last, world);
    }
    /// Waits for the frames that are still being written, and throws what went wrong with one.
    void finish_frames()
    {
        if (vtk_) vtk_->wait();
        if (pictures_) pictures_->wait();
        check_frames();
    }
    void close()
    {
        finish_frames();
        history_.close();
    }

  private:
    void check_frames()
    {
        if (vtk_) vtk_->check();
        if (pictures_) pictures_->check();
    }

    History history_;
    std::optional<VtkFrames> vtk_;
    std::optional<Pictures> pictures_;
};

/// One run: steps from frame to frame.
class Run {
  public:
    Run(const SceneFile& scene, const PreparedScene& prepared, SceneWorld& world, const RunOptions& options,
        RunObserver& observer)
        : scene_(scene), prepared_(prepared), world_(world), options_(options), observer_(observer),
          tally_(scene, prepared, world)
    {
    }

    void record_into(const std::filesystem::path& directory)
    {
        recorder_.emplace(directory, scene_, prepared_, world_, options_.threads);
    }

    void go()
    {
        try {
            step_from_frame_to_frame();
        } catch (...) {
            if (recorder_) recorder_->finish_frames(); // what went wrong with an earlier frame did so first
            throw;
        }
        if (recorder_) recorder_->close();
    }

    [[nodiscard]] RunReport report(const std::string& failure) const
    {
        RunReport report = tally_.report();
        report.version = kVersion;
        report.threads = Workers(options_.threads).threads();
        report.wall_seconds = seconds();
        report.peak_memory_bytes = peak_memory_bytes();
        const std::vector<std::string>& of_world = world_.fluid().notes();
        report.notes.insert(report.notes.begin(), of_world.begin(), of_world.end());
        report.notes.insert(report.notes.begin(), prepared_.notes.begin(), prepared_.notes.end());
        report.failure = failure;
        return report;
    }

  private:
    void step_from_frame_to_frame()
    {
        const double frames = scene_.duration * scene_.output.frames_per_second;
        const int last = std::max(1, static_cast<int>(std::ceil(frames * (1.0 - 1e-9))));
        add_frame(0, false);
        for (int frame = 1; frame <= last; ++frame) {
            step_until(frame == last ? scene_.duration : frame / scene_.output.frames_per_second);
            add_frame(frame, frame == last);
        }
    }

    [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    /// What is left up to the frame is cut into equal steps, so that none is left over that is tiny.
    void step_until(double time)
    {
        const double accuracy = 1e-9 * scene_.duration;
        for (double left = time - world_.fluid().time(); left > accuracy; left = time - world_.fluid().time()) {
            const double allowed = world_.fluid().allowed_time_step();
            if (!(allowed > accuracy))
                throw RunFailure(scene_.file.string() + ": the time step fell to " + in_words(allowed) +
                                 " s at t = " + std::to_string(world_.fluid().time()) +
                                 " s, with which the run would not end; forces, speeds or viscosity are too large");
            const StepReport step = world_.step(left / std::ceil(left / allowed * (1.0 - 1e-9)));
            refuse_broken_state(step, scene_, world_);
            tally_.add(step);
            if (recorder_) recorder_->add_step(world_, step.dt);
            observer_.on_step({world_.fluid().time(), scene_.duration, seconds(), tally_.steps()});
        }
    }
    void add_frame(int frame, bool last)
    {
        if (recorder_) recorder_->add_frame(frame, last, scene_, prepared_, world_);
    }

    const SceneFile& scene_;
    const PreparedScene& prepared_;
    SceneWorld& world_;
    const RunOptions& options_;
    RunObserver& observer_;
    RunTally tally_;
    std::optional<Recorder> recorder_;
    Clock::time_point start_ = Clock::now();
};

/// Keeps what was recorded, with a report if one can still be written, and throws on.
[[noreturn]] void fail(const Run& run, OutputDirectory* out, const std::string& sentence)
{
    if (!out) throw RunFailure(sentence);
    try {
        write_text_atomically(out->path() / "report.json", report_as_json(run.report(sentence)));
    } catch (const OutputError&) { // the disk that is full, of which the sentence speaks already
    }
    throw RunFailure(sentence + "; what there is stays in " + out->keep_partial().string());
}

} // namespace
} // namespace scene

RunReport run_scene(const SceneFile& file, const RunOptions& options, RunObserver& observer)
{
    const scene::PreparedScene prepared = scene::prepare_and_check(file);
    std::optional<OutputDirectory> out;
    if (!options.out.empty()) out.emplace(options.out);
    scene::SceneWorld world(file, prepared, options.threads,
                            [&](const SettleProgress& progress) { observer.on_settle(progress); });
    scene::Run run(file, prepared, world, options, observer);
    observer.on_start(world.fluid().fluid().size(), world.fluid().boundary().size(), run.report("").notes);
    try {
        if (out) run.record_into(out->path());
        run.go();
        RunReport report = run.report("");
        if (out) {
            write_text_atomically(out->path() / "report.json", report_as_json(report));
            out->commit();
        }
        return report;
    } catch (const InputError&) { // somebody took the name of the output meanwhile
        throw;
    } catch (const std::runtime_error& error) {
        scene::fail(run, out ? &*out : nullptr, error.what());
    }
}

} // namespace flotsam
