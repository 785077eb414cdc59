#include "flotsam/scene/run_scene.hpp"
#include "scene_texts.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <filesystem>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

constexpr double kG = 9.81;

struct Watcher final : RunObserver {
    void on_start(std::size_t, std::size_t, const std::vector<std::string>&) override {}
    void on_step(const RunProgress&) override {}
};

/// Two boxes of 2 kg in a row, far from the water, the first with its end at (2, 2, 2).
const std::string kDry = R"({
  "flotsam": 1, "particle_spacing": 0.1, "duration": 0.4, "time_step": {"max": 0.001},
  "fluids": [{"blocks": [{"min": [0,0,0], "max": [0.3,0.3,0.2]}]}],
  "walls": [{"box": {"min": [0,0,0], "max": [4,4,4], "open": ["+z"]}}],
  "bodies": [{"name": "upper", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [2.2,2,2], "friction": 0},
             {"name": "lower", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [2.7,2,2], "friction": 0}],
  "joints": [{"name": "elbow", "type": "hinge", "a": "lower", "b": "upper", "point": [2.45,2,2], "axis": [0,-1,0]},
             {"name": "shoulder", "type": "hinge", "a": "upper", "point": [2,2,2], "axis": [0,1,0]}],
  "articulations": [{"joints": ["elbow", "shoulder"]}]
})";
constexpr double kInertia = 2.0 / 12.0 * (0.4 * 0.4 + 0.2 * 0.2); ///< of a box about the y axis

RunReport ran(const std::string& text, const std::vector<std::string>& overrides = {})
{
    Watcher watcher;
    return run_scene(parse_scene(text, "test.json", overrides), {{}, 1}, watcher);
}

double kinetic_energy(const BodyReport& body, double spin)
{
    return 0.5 * 2.0 * body.velocity.squaredNorm() + 0.5 * kInertia * spin * spin;
}

} // namespace

TEST_CASE("an arm in reduced coordinates swings, keeps its energy and does not open", "[scene][articulation]")
{
    const RunReport report = ran(kDry);
    const BodyReport &upper = report.bodies.at(0), &lower = report.bodies.at(1);
    CHECK(upper.position.z() < 1.9);
    CHECK((upper.position - Vec3d(2, 2, 2)).norm() == Approx(0.2).margin(1e-9));
    const double turn = -lower.rotation_deg.y() / 57.295779513, way = -upper.rotation_deg.y() / 57.295779513;
    const Vec3d elbow = Vec3d(2, 2, 2) + 0.45 * Vec3d(std::cos(way), 0, std::sin(way));
    CHECK((lower.position - elbow).isApprox(0.25 * Vec3d(std::cos(turn), 0, std::sin(turn)), 1e-9));
    const double fallen = 2.0 * kG * (4.0 - upper.position.z() - lower.position.z());
    const Vec3d elbow_velocity = 0.45 / 0.2 * upper.velocity;
    const double spin = upper.velocity.norm() / 0.2, lower_spin = (lower.velocity - elbow_velocity).norm() / 0.25;
    CHECK(kinetic_energy(upper, spin) + kinetic_energy(lower, lower_spin) == Approx(fallen).epsilon(0.01));
    // Positive is a turn of `a` about the axis, seen from `b`.
    CHECK(report.joints.at(1).angle_deg.value() == Approx(upper.rotation_deg.y()));
    CHECK(report.joints.at(0).angle_deg.value() == Approx(upper.rotation_deg.y() - lower.rotation_deg.y()));
}

TEST_CASE("loads of swinging joints are those of the same joints as constraints", "[scene][articulation]")
{
    const RunReport reduced = ran(kDry), held = ran(kDry, {"articulations=[]"});
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        const double scale = held.joints.at(k).force_mean.norm();
        CHECK(scale > 30.0);
        CHECK((reduced.joints.at(k).force_mean - held.joints.at(k).force_mean).norm() < 0.02 * scale);
        CHECK(reduced.joints.at(k).torque_mean.norm() < 0.005 * scale * 0.4); // hinges without motors
    }
}

TEST_CASE("bodies of an articulation start as fast as their joints let them", "[scene][articulation]")
{
    const std::vector<std::string> turning{"gravity=[0,0,0]",
                                           "duration=0.01",
                                           "bodies.upper.velocity=[0,0.3,-0.4]",
                                           "bodies.upper.angular_velocity=[1,2,0]",
                                           "bodies.lower.velocity=[0,0,-1.4]",
                                           "bodies.lower.angular_velocity=[0,2,0]"};
    const RunReport report = ran(kDry, turning);
    CHECK(report.bodies.at(0).velocity.isApprox(Vec3d(0, 0, -0.4), 0.05)); // its hinges hold it along y and about x
    CHECK(report.bodies.at(0).rotation_deg.isApprox(0.01 * 57.295779513 * Vec3d(0, 2, 0), 0.05));
    CHECK(report.bodies.at(1).velocity.isApprox(Vec3d(0, 0, -1.4), 0.05));
}

TEST_CASE("an articulation without a joint to the world floats freely", "[scene][articulation]")
{
    // A motor turns the two against each other: nothing else changes their momenta.
    const std::vector<std::string> free{
        "gravity=[0,0,0]", R"(articulations=[{"joints": ["elbow"]}])",
        R"(joints=[{"name": "elbow", "type": "hinge", "a": "lower", "b": "upper", "point": [2.45,2,2], "axis": [0,1,0],
                    "motor": {"velocity": 3, "max_torque": 0.5}}])"};
    const RunReport report = ran(kDry, free);
    // Bullet steps joints, not momenta: those of a free multibody are kept to the first order of the step.
    CHECK((report.bodies.at(0).velocity + report.bodies.at(1).velocity).norm() < 2e-3);
    CHECK((report.bodies[0].position + report.bodies[1].position).isApprox(Vec3d(4.9, 4, 4), 1e-3));
    const double angle = report.joints.at(0).angle_deg.value(); // alike, they turn by half of it each
    CHECK(report.bodies[0].rotation_deg.isApprox(Vec3d(0, -0.5 * angle, 0), 1e-3));
    CHECK(report.bodies[1].rotation_deg.isApprox(Vec3d(0, 0.5 * angle, 0), 1e-3));
    CHECK(angle > 20.0);
    CHECK(report.joints.at(0).torque_mean.y() <= 0.5 * (1.0 + 1e-6));
}

TEST_CASE("a link that rests on the floor shares its weight with it", "[scene][articulation]")
{
    // A box of 1 m on a hinge 0.4 m over the floor comes to rest on its far end: each bears half, without friction.
    const std::vector<std::string> resting{
        "duration=2", R"(articulations=[{"joints": ["pin"]}])",
        R"(bodies=[{"name": "bar", "shape": {"box": [1,0.2,0.05]}, "mass": 2, "position": [2.5,2,0.4], "friction": 0}])",
        R"(joints=[{"name": "pin", "type": "hinge", "a": "bar", "point": [2,2,0.4], "axis": [0,1,0]}])"};
    const RunReport report = ran(kDry, resting);
    const JointReport& pin = report.joints.at(0);
    CHECK(pin.angle_deg.value() > 15.0);
    CHECK(report.bodies.at(0).velocity.norm() < 1e-3);
    const double turn = pin.angle_deg.value() / 57.295779513, beside = 0.5 * std::cos(turn);
    const double under = std::cos(turn) - 0.025 * std::sin(turn); // the lower edge of the far end
    CHECK(pin.force_mean.z() == Approx(2.0 * kG * (1.0 - beside / under)).epsilon(0.01));
    CHECK(std::abs(pin.force_mean.x()) < 0.01 * 2.0 * kG);
    CHECK(std::abs(pin.torque_mean.y()) < 0.01 * 2.0 * kG * 0.5); // the two corners may bear unequal parts about x
}

TEST_CASE("joints of an articulation bear the weight of their links less that of the water", "[scene][articulation]")
{
    const std::string links = R"({
      "flotsam": 1, "dimensions": 2, "particle_spacing": 0.02, "duration": 0.8,
      "fluids": [{"blocks": [{"min": [0,0], "max": [0.8,0.4]}]}],
      "walls": [{"box": {"min": [0,0], "max": [0.8,0.6], "open": ["+z"]}}],
      "bodies": [{"name": "a", "shape": {"box": [0.2,0.1]}, "density": 3000, "position": [0.2,0.2]},
                 {"name": "b", "shape": {"box": [0.2,0.1]}, "density": 3000, "position": [0.5,0.2]}],
      "joints": [{"name": "shoulder", "type": "hinge", "a": "a", "point": [0.1,0.2],
                  "motor": {"velocity": 0, "max_torque": 500}},
                 {"name": "elbow", "type": "slider", "a": "b", "b": "a", "point": [0.35,0.2], "axis": [0,1],
                  "motor": {"velocity": 0, "max_force": 800}}],
      "articulations": [{"joints": ["shoulder", "elbow"]}]
    })";
    const RunReport report = ran(links);
    const double weight = 2000.0 * 0.2 * 0.1 * kG; // in water, of a link [N/m]
    CHECK(report.joints.at(0).force_mean.z() == Approx(2.0 * weight).epsilon(0.02));
    CHECK(report.joints.at(0).torque_mean.y() == Approx(-(0.1 + 0.4) * weight).epsilon(0.02));
    CHECK(report.joints.at(1).force_mean.z() == Approx(weight).epsilon(0.02));
    CHECK(report.joints.at(1).torque_mean.y() == Approx(-0.15 * weight).epsilon(0.02));
    CHECK(report.ledger.errors().momentum.norm() < 1e-5 * report.ledger.scales().momentum);
    CHECK(std::abs(report.joints.at(0).angle_deg.value()) < 1e-6);
}

TEST_CASE("joints of an arm bear the weight of its links less that of the water", "[scene][articulation]")
{
    Watcher watcher;
    const SceneFile arm =
        read_scene(std::filesystem::path(FLOTSAM_DATA_DIR) / "scenes/arm_in_water.json", {"output.pictures=false"});
    const RunReport report = run_scene(arm, {{}, 0}, watcher);
    const double weight = 1500.0 * 0.2 * 0.08 * 0.08 * kG; // in water, of a link
    for (std::size_t k = 0; k < 3; ++k) {
        const double links = 3.0 - static_cast<double>(k);
        CHECK(report.joints.at(k).force_mean.z() == Approx(links * weight).epsilon(0.02));
        CHECK(report.joints.at(k).torque_mean.y() == Approx(-links * weight * 0.1 * links).epsilon(0.03));
        CHECK(std::abs(report.joints.at(k).angle_deg.value()) < 1e-6);
    }
}

TEST_CASE("bad articulations are refused with the place and what is allowed", "[scene][articulation]")
{
    const std::string bodies = R"(bodies=[{"name":"a","shape":{"sphere":0.1},"mass":1},
        {"name":"b","shape":{"sphere":0.1},"mass":1}, {"name":"c","shape":{"sphere":0.1},"mass":1,"lock":["x"]},
        {"name":"post","shape":{"sphere":0.1},"motion":"fixed"}])";
    const std::string joints = R"(joints=[{"name":"root","type":"ball","a":"a","point":[0,0,0]},
        {"name":"ab","type":"ball","a":"b","b":"a","point":[0,0,0]},
        {"name":"ba","type":"ball","a":"a","b":"b","point":[0,0,0]},
        {"name":"bw","type":"ball","a":"b","point":[0,0,0]},
        {"name":"ac","type":"ball","a":"a","b":"c","point":[0,0,0]},
        {"name":"at_post","type":"ball","a":"a","b":"post","point":[0,0,0]}])";
    struct Case {
        const char* articulations;
        std::vector<std::string> parts;
    };
    const Case each = GENERATE(values<Case>({
        {R"([{"joints": ["rot"]}])", {"articulations[0].joints[0] must be the name of a joint", "nearest is \"root\""}},
        {R"([{"joints": ["root", "root"]}])", {"articulations[0].joints[1] must be in one articulation, and once"}},
        {R"([{"joints": ["ab"]}, {"joints": ["ab"]}])", {"articulations[0] has the body", "holds as well; that joint"}},
        {R"([{"joints": ["root", "ba"]}])", {"joints[1] holds \"a\" as \"a\", as \"root\" does"}},
        {R"([{"joints": ["ab", "ba"]}])", {"articulations[0] is a ring of joints"}},
        {R"([{"joints": ["ac"]}])", {"joints[0] holds \"c\"", "no \"lock\""}},
        {R"([{"joints": ["at_post"]}])", {"joints[0] holds \"post\", which must be dynamic"}},
        {R"([{"joints": ["root", "bw"]}])", {"has the body \"b\", which \"ab\" holds as well"}},
        {R"([{"joints": []}])", {"articulations[0].joints must name at least one joint"}},
        {R"([{}])", {"articulations[0] lacks the required key \"joints\""}},
        {R"([{"joint": ["root"]}])", {"articulations[0].joint is an unknown key", "\"joints\""}},
        {R"({"joints": ["root"]})", {"articulations must be a list"}},
    }));
    const std::string sentence =
        refusal_of(kCrate, {bodies, joints, "articulations=" + std::string(each.articulations)});
    INFO(each.articulations << " gives: " << sentence);
    CHECK(sentence.find("test.json: ") != std::string::npos);
    for (const std::string& part : each.parts) CHECK(sentence.find(part) != std::string::npos);
}

TEST_CASE("an articulation hangs from one place, in 2-D from the world", "[scene][articulation]")
{
    const std::string bodies = R"(bodies=[{"name":"a","shape":{"sphere":0.1},"mass":1},
        {"name":"b","shape":{"sphere":0.1},"mass":1}, {"name":"c","shape":{"sphere":0.1},"mass":1}])";
    const std::string two = refusal_of(kCrate, {bodies, R"(joints=[{"name":"u","type":"ball","a":"a","point":[0,0,0]},
        {"name":"v","type":"ball","a":"b","b":"c","point":[0,0,0]}])",
                                                R"(articulations=[{"joints": ["u", "v"]}])"});
    CHECK(two.find("articulations[0] hangs from the world and from \"c\", and must hang from one") !=
          std::string::npos);
    const std::string none = refusal_of(kCrate, {R"(articulations=[{"joints": ["u"]}])"});
    CHECK(none.find("the scene has none") != std::string::npos);
    const std::string flat = refusal_of(
        kRaft, {R"(bodies=[{"name":"a","shape":{"disc":0.1},"mass":1},{"name":"b","shape":{"disc":0.1},"mass":1}])",
                R"(joints=[{"name":"v","type":"hinge","a":"a","b":"b","point":[0,0]}])",
                R"(articulations=[{"joints": ["v"]}])"});
    CHECK(flat.find("articulations[0] must hang from the world in two dimensions") != std::string::npos);
    CHECK(parsed(kCrate, {bodies, R"(joints=[{"name":"u","type":"ball","a":"a","b":"c","point":[0,0,0]},
        {"name":"v","type":"ball","a":"b","b":"c","point":[0,0,0]}])",
                          R"(articulations=[{"joints": ["u", "v"]}])"})
              .articulations.at(0)
              .joints.size() == 2);
}
