#include "flotsam/scene/check_scene.hpp"
#include "flotsam/scene/run_scene.hpp"
#include "scene/prepared_scene.hpp"
#include "scene_texts.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

/// The scene of the text, started at rest and checked.
scene::PreparedScene prepared(const std::string& text, std::vector<std::string> overrides = {})
{
    overrides.emplace_back("start=at_rest");
    return scene::prepare_and_check(parsed(text, overrides));
}

bool has_note(const std::vector<std::string>& notes, const std::string& part)
{
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

/// Cubes of half the water's density would not stay upright.
const std::string kUpright = R"(bodies.crate.lock=["rx","ry"])";

double height(const scene::PreparedScene& scene, std::size_t body = 0)
{
    return scene.bodies.at(body).start.position.z();
}

std::string box(const std::string& name, const std::string& position, const std::string& rest)
{
    return R"({"name": ")" + name + R"(", "shape": {"box": [0.2, 0.2, 0.2]}, "lock": ["rx", "ry"], "position": )" +
           position + ", " + rest + "}";
}

} // namespace

TEST_CASE("in a scene that starts at rest bodies stand at their exact drafts", "[scene][rest]")
{
    // A cube of half the water's density has half of its 0.2 m under water that is 0.4 m deep.
    for (const char* position : {"[0.5,0.5,0.8]", "[0.5,0.5,0.2]"}) { // above the water and deep in it
        const std::vector<std::string> there{std::string("bodies.crate.position=") + position, kUpright};
        const auto scene = prepared(kCrate, there);
        CHECK(height(scene) == Approx(0.4).margin(1e-9)); // rounding
        CHECK(scene.bodies[0].start.position.head<2>() == Eigen::Vector2d(0.5, 0.5));
        CHECK(has_note(scene.notes, "bodies[0] (\"crate\") was moved"));
        CHECK(height(scene::prepare_and_check(parsed(kCrate, there))) != Approx(0.4)); // only if it is asked for
    }
    CHECK(has_note(prepared(kCrate, {kUpright, "bodies.crate.position=[0.5,0.5,0.8]"}).notes, "moved down by 400 mm"));
    CHECK(has_note(prepared(kCrate, {kUpright, "bodies.crate.position=[0.5,0.5,0.2]"}).notes, "moved up by 200 mm"));
    CHECK_FALSE(has_note(prepared(kCrate, {kUpright}).notes, "was moved")); // it is there already
    CHECK(height(prepared(kCrate, {kUpright, "bodies.crate.density=250"})) == Approx(0.45).margin(1e-9));
    // On its edge, half of it is under water in the same place; a quarter is as a triangle of 0.1 m.
    const std::string turned = "bodies.crate.rotation_deg=[0,45,0]";
    CHECK(height(prepared(kCrate, {kUpright, turned})) == Approx(0.4).margin(1e-9));
    CHECK(height(prepared(kCrate, {kUpright, turned, "bodies.crate.density=250"})) ==
          Approx(0.4 - 0.1 + 0.1 * std::sqrt(2.0)).margin(1e-9));
    CHECK(height(prepared(kRaft, {"bodies.raft.position=[0.5,0.6]", "bodies.raft.density=200"})) ==
          Approx(0.3 - 0.02 + 0.05).margin(1e-9));
}

TEST_CASE("in a scene that starts at rest bodies lie in the stable pose that they come to", "[scene][rest]")
{
    const auto tilt_deg = [](const scene::PreparedScene& scene) {
        const Vec3d up = scene.bodies.at(0).start.orientation * Vec3d::UnitZ();
        return std::acos(std::clamp(up.z(), -1.0, 1.0)) * 180.0 / std::numbers::pi;
    };
    // In the plane a square of half the density floats on its edge, and one of a quarter at atan 1/2 (Reid 1963).
    const std::vector<std::string> square{"bodies.raft.shape={\"box\": [0.2, 0.2]}",
                                          "bodies.raft.rotation_deg=[0,7,0]"};
    const auto with = [&](const std::string& change) {
        std::vector<std::string> changes = square;
        changes.push_back(change);
        return prepared(kRaft, changes);
    };
    const auto half = with("bodies.raft.density=500");
    CHECK(tilt_deg(half) == Approx(45.0).margin(0.1));
    CHECK(half.bodies[0].start.orientation.vec().cwiseAbs().dot(Vec3d(1, 0, 1)) < 1e-9); // about y alone
    CHECK(has_note(half.notes, "turned by 38 degrees to where it floats"));
    CHECK(tilt_deg(with("bodies.raft.density=250")) == Approx(26.565).margin(0.1));
    CHECK(tilt_deg(with("bodies.raft.density=100")) == Approx(0.0).margin(0.1));
    std::vector<std::string> held = square;
    held.insert(held.end(), {"bodies.raft.density=500", "bodies.raft.lock=[\"ry\"]"});
    CHECK(tilt_deg(prepared(kRaft, held)) == Approx(7.0).margin(1e-6));
    const auto disc = prepared(kRaft, {"bodies.raft.shape={\"disc\": 0.1}", "bodies.raft.density=500"});
    CHECK(disc.bodies[0].start.orientation.isApprox(Quatd::Identity(), 0.0)); // as good as any other way
    // A plate in space rights itself and keeps its heading.
    const auto plate =
        prepared(kCrate, {"bodies.crate.shape={\"box\": [0.2, 0.2, 0.04]}", "bodies.crate.rotation_deg=[20,0,0]"});
    CHECK(tilt_deg(plate) == Approx(0.0).margin(1e-3));
    CHECK(height(plate) == Approx(0.4).margin(1e-6));
}

TEST_CASE("what does not float freely stays as it is given", "[scene][rest]")
{
    const auto stays = [](const std::vector<std::string>& changes, const std::string& why) {
        std::vector<std::string> overrides = changes;
        overrides.emplace_back("bodies.crate.position=[0.5,0.5,0.7]");
        const auto scene = prepared(kCrate, overrides);
        INFO(why);
        CHECK(height(scene) == 0.7);
        CHECK_FALSE(has_note(scene.notes, "was moved"));
        if (!why.empty())
            CHECK(has_note(scene.notes, "\"crate\") stays as given in a scene that starts at rest: " + why));
    };
    stays({"bodies.crate.lock=[\"z\"]"}, "it is locked along z");
    stays({R"(joints=[{"type": "ball", "a": "crate", "point": [0.5, 0.5, 0.9]}])"}, "a joint holds it");
    stays({"fluids.0.blocks.0.max=[0.4, 1, 0.4]"}, "no block or mesh of fluid is under its middle");
    stays({"fluids.0.blocks.0.max=[1, 1, 0.05]"}, "where it would float it meets a wall"); // 0.1 m of draft
    stays({"bodies.crate.density=1100"}, "");
    stays({"bodies.crate.density=1000"}, "");
    stays({"bodies.crate.motion=fixed"}, "");
    stays({"gravity=[0,0,0]"}, "");
    stays({"gravity=[1,0,-9]"}, "");
    const std::vector<std::string> locked{"bodies.crate.lock=[\"x\",\"rx\",\"ry\"]",
                                          "bodies.crate.position=[0.5,0.5,0.7]"};
    CHECK(height(prepared(kCrate, locked)) == Approx(0.4).margin(1e-9)); // other axes do not hold it up
}

TEST_CASE("bodies that touch keep together, and none is put into another", "[scene][rest]")
{
    const std::string raft = box("raft", "[0.5, 0.5, 0.6]", "\"density\": 300");
    const std::string stone = box("stone", "[0.5, 0.5, 0.8]", "\"density\": 600");
    const auto stacked = prepared(kCrate, {"bodies=[" + raft + "," + stone + "]"});
    CHECK(height(stacked, 0) == 0.6);
    CHECK(height(stacked, 1) == 0.8);
    CHECK(has_note(stacked.notes, "(\"raft\") stays as given in a scene that starts at rest: it touches bodies[1]"));

    const std::string above = box("above", "[0.5, 0.5, 0.9]", "\"density\": 600"); // 0.1 m between
    const auto apart = prepared(kCrate, {"bodies=[" + raft + "," + above + "]"});
    CHECK(height(apart, 0) == Approx(0.4 + 0.1 - 0.06).margin(1e-9));
    CHECK(height(apart, 1) == 0.9);
    CHECK(has_note(apart.notes, "(\"above\") stays as given in a scene that starts at rest: where it would float it "
                                "meets bodies[0] (\"raft\")"));

    const std::string beside = box("beside", "[0.25, 0.5, 0.6]", "\"density\": 300"); // 0.05 m between
    const auto both = prepared(kCrate, {"bodies=[" + raft + "," + beside + "]"});
    CHECK(height(both, 0) == height(both, 1));
    CHECK(height(both, 0) == Approx(0.44).margin(1e-9));
}

TEST_CASE("the water level is that of the water under the body", "[scene][rest]")
{
    // A low and a high tank beside each other, each with its water; one of them filled by two blocks.
    const std::string text = R"({"flotsam": 1, "particle_spacing": 0.05, "duration": 0.1, "start": "at_rest",
      "fluids": [{"blocks": [{"min": [0, 0, 0.2], "max": [1, 1, 0.4]}, {"min": [0, 0, 0], "max": [1, 1, 0.2]},
                             {"min": [2, 0, 1], "max": [3, 1, 1.5]}, {"min": [0, 0, 1.4], "max": [1, 1, 1.6]}]}],
      "bodies": [)" + box("low", "[0.5, 0.5, 0.15]", "\"density\": 500") +
                             "," + box("high", "[2.5, 0.5, 2]", "\"density\": 500") + "]}";
    const auto scene = prepared(text);
    CHECK(height(scene, 0) == Approx(0.4).margin(1e-9)); // not at 1.6 m
    CHECK(height(scene, 1) == Approx(1.5).margin(1e-9));
}

TEST_CASE("a run that starts at rest reports bodies where they float", "[scene][rest]")
{
    const auto ran = [](const std::string& start, int threads) {
        SilentObserver silent;
        return run_scene(parsed(kRaft, {"start=" + start, "bodies.raft.position=[0.5,0.4]", "duration=0.05"}),
                         {{}, threads}, silent);
    };
    const RunReport given = ran("as_given", 1), rest = ran("at_rest", 1);
    CHECK(has_note(rest.notes, "bodies[0] (\"raft\") was moved down by 100 mm"));
    CHECK_FALSE(has_note(given.notes, "was moved"));
    REQUIRE(given.bodies.at(0).velocity.norm() > 0.3); // it falls
    CHECK(rest.bodies.at(0).velocity.norm() < 0.02);   // a twentieth of it and of free fall
    CHECK(rest.bodies[0].draft.value() == Approx(rest.bodies[0].exact_draft.value()).margin(0.005)); // d / 4
    CHECK(ran("at_rest", 3).state_hash == rest.state_hash);
}

TEST_CASE("an observer is told how the water comes to rest, before the run starts", "[scene][rest]")
{
    struct Watcher final : RunObserver {
        int rounds = 0, rounds_at_start = 0;
        void on_settle(const SettleProgress& progress) override { rounds = progress.rounds; }
        void on_start(std::size_t, std::size_t, const std::vector<std::string>&) override { rounds_at_start = rounds; }
        void on_step(const RunProgress&) override {}
    };
    Watcher given, rest;
    run_scene(parsed(kRaft, {"duration=0.01"}), {{}, 1}, given);
    run_scene(parsed(kRaft, {"duration=0.01", "start=at_rest"}), {{}, 1}, rest);
    CHECK(given.rounds == 0);
    CHECK(rest.rounds_at_start >= 20);
    CHECK(rest.rounds == rest.rounds_at_start);
}
