#include "flotsam/scene/run_scene.hpp"
#include "scene_texts.hpp"
#include "support/catch.hpp"
#include "support_directory.hpp"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

using namespace flotsam;
using namespace flotsam::testing;

namespace fs = std::filesystem;

namespace {

/// Calls something at the start and after each step.
struct Meddler final : RunObserver {
    std::function<void()> at_start = [] {}, after_step = [] {};
    void on_start(std::size_t, std::size_t, const std::vector<std::string>&) override { at_start(); }
    void on_step(const RunProgress&) override { after_step(); }
};

const std::string kVtk = "output={\"frames_per_second\": 100, \"vtk\": true}";
const std::string kPictures =
    "output={\"frames_per_second\": 100, \"pictures\": {\"width\": 64, \"height\": 36, \"every\": 1}}";
const std::string kBoth =
    "output={\"frames_per_second\": 100, \"vtk\": true, \"pictures\": {\"width\": 64, \"height\": 36, \"every\": 4}}";

std::set<std::string> names_in(const fs::path& directory)
{
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) names.insert(entry.path().filename().string());
    return names;
}

/// What the .pvd says: times and files.
std::vector<std::pair<double, std::string>> frames_of(const std::string& pvd)
{
    static const std::regex entry("timestep=\"([^\"]*)\" group=\"\" part=\"0\" file=\"([^\"]*)\"");
    std::vector<std::pair<double, std::string>> frames;
    for (auto it = std::sregex_iterator(pvd.begin(), pvd.end(), entry); it != std::sregex_iterator(); ++it)
        frames.emplace_back(std::stod((*it)[1]), (*it)[2]);
    return frames;
}

/// The sentence with which the run fails; empty when it does not.
std::string failure_of(const SceneFile& scene, const fs::path& out, RunObserver& observer)
{
    try {
        (void)run_scene(scene, {out, 2}, observer);
    } catch (const RunFailure& failure) {
        return failure.what();
    }
    return {};
}

/// Threads of this process.
std::ptrdiff_t thread_count()
{
    return std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator());
}

} // namespace

TEST_CASE("all frames are there when a run ends, in order", "[scene][run][frames]")
{
    const TemporaryDirectory directory("flotsam_frames");
    const fs::path out = directory.path() / "out";
    Meddler silent;
    (void)run_scene(parsed(kRaft, {kBoth}), {out, 2}, silent);
    for (const char* what : {"particles", "bodies"}) {
        const auto frames = frames_of(directory.read(std::string("out/") + what + ".pvd"));
        REQUIRE(frames.size() == 11);
        for (std::size_t k = 0; k < frames.size(); ++k) {
            INFO(frames[k].second);
            CHECK(frames[k].first == Approx(0.01 * static_cast<double>(k)).margin(1e-9));
            CHECK(frames[k].second ==
                  std::string("vtk/") + what + (k < 10 ? "_000" : "_00") + std::to_string(k) + ".vtp");
            CHECK(directory.read("out/" + frames[k].second).find("</VTKFile>") != std::string::npos);
        }
    }
    CHECK(names_in(out / "vtk").size() == 11 + 11 + 1);
    CHECK(names_in(out / "pictures") ==
          std::set<std::string>{"frame_0000.png", "frame_0004.png", "frame_0008.png", "frame_0010.png"});
    for (const std::string& name : names_in(out / "pictures"))
        CHECK(directory.read("out/pictures/" + name).find("IEND") != std::string::npos);
}

TEST_CASE("frames do not depend on the number of threads", "[scene][run][frames][determinism]")
{
    const TemporaryDirectory directory("flotsam_frames_threads");
    for (const int threads : {1, 3}) {
        Meddler silent;
        (void)run_scene(parsed(kRaft, {kBoth}), {directory.path() / std::to_string(threads), threads}, silent);
    }
    for (const char* folder : {"vtk", "pictures"}) {
        const auto names = names_in(directory.path() / "1" / folder);
        REQUIRE(names.size() >= 4);
        for (const std::string& name : names) {
            INFO(name);
            const std::string file = std::string("/") + folder + "/" + name;
            CHECK(directory.read("1" + file) == directory.read("3" + file));
        }
    }
    CHECK(directory.read("1/history.csv") == directory.read("3/history.csv"));
}

TEST_CASE("a frame that cannot be written ends the run with its sentence", "[scene][run][frames]")
{
    struct Case {
        const char* folder;
        std::string output;
    };
    const Case each = GENERATE(values<Case>({{"vtk", kVtk}, {"pictures", kPictures}, {"vtk", kBoth}}));
    const TemporaryDirectory directory("flotsam_frames_gone");
    const fs::path out = directory.path() / "out";
    const fs::path writing_to = out.string() + ".partial-" + std::to_string(getpid());
    Meddler thief;
    thief.after_step = [&] { // at one stroke: frames are being written
        std::error_code gone_already;
        fs::rename(writing_to / each.folder, directory.path() / "stolen", gone_already);
    };
    const std::string sentence = failure_of(parsed(kRaft, {each.output}), out, thief);
    INFO(each.folder << ": " << sentence);
    CHECK(sentence.rfind("cannot write " + (writing_to / each.folder).string(), 0) == 0);
    CHECK(sentence.find(": No such file or directory; what there is stays in " + out.string() + ".partial") !=
          std::string::npos);
    CHECK_FALSE(fs::exists(out));
    const auto report = nlohmann::json::parse(directory.read("out.partial/report.json"));
    CHECK(sentence.rfind(report["failure"].get<std::string>() + ";", 0) == 0);
    CHECK(report["simulated_seconds"].get<double>() < 0.1); // it did not go on to the end
    if (fs::exists(directory.path() / "out.partial/pictures"))
        for (const std::string& name : names_in(directory.path() / "out.partial/pictures"))
            CHECK(directory.read("out.partial/pictures/" + name).find("IEND") != std::string::npos);
}

TEST_CASE("a run that fails leaves the frames it got to, whole", "[scene][run][frames]")
{
    const TemporaryDirectory directory("flotsam_frames_failed");
    SceneFile scene = parsed(kRaft, {kBoth});
    scene.fluid.kinematic_viscosity = 1000.0; // the time step falls to nothing
    scene.duration = 100.0;
    Meddler silent;
    const std::string sentence = failure_of(scene, directory.path() / "out", silent);
    CHECK(sentence.find("the time step fell to") != std::string::npos);
    CHECK(names_in(directory.path()) == std::set<std::string>{"out.partial"});
    CHECK(frames_of(directory.read("out.partial/particles.pvd")).size() == 1);
    CHECK(directory.read("out.partial/vtk/particles_0000.vtp").find("</VTKFile>") != std::string::npos);
    CHECK(directory.read("out.partial/pictures/frame_0000.png").find("IEND") != std::string::npos);
}

TEST_CASE("a run that its observer breaks off leaves nothing", "[scene][run][frames]")
{
    const TemporaryDirectory directory("flotsam_frames_broken_off");
    Meddler breaker;
    breaker.after_step = [] { throw std::logic_error("enough"); };
    CHECK_THROWS_WITH(run_scene(parsed(kRaft, {kBoth}), {directory.path() / "out", 2}, breaker), "enough");
    CHECK(names_in(directory.path()).empty());
}

TEST_CASE("only a run that writes frames has a thread for them", "[scene][run][frames]")
{
    const bool writes_frames = GENERATE(false, true); // pictures as well have the ray tracer's threads
    const TemporaryDirectory directory("flotsam_frames_none");
    std::ptrdiff_t before = 0, most = 0;
    Meddler counter;
    counter.at_start = [&] { before = thread_count(); };
    counter.after_step = [&] { most = std::max(most, thread_count()); };
    (void)run_scene(parsed(kRaft, {writes_frames ? kVtk : "output={}"}), {directory.path() / "out", 1}, counter);
    REQUIRE(before >= 1);
    CHECK(most - before == (writes_frames ? 1 : 0));
}
