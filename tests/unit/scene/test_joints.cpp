#include "flotsam/scene/run_scene.hpp"
#include "scene_texts.hpp"
#include "support/catch.hpp"
#include "support_directory.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <numbers>
#include <sstream>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

constexpr double kRadian = 180.0 / std::numbers::pi; // [degrees]
constexpr double kG = 9.81;

struct Watcher final : RunObserver {
    void on_start(std::size_t, std::size_t, const std::vector<std::string>&) override {}
    void on_step(const RunProgress&) override {}
};

/// A large tank with a little water in a corner, far from the bodies: a box of 2 kg with its middle at 2, 2, 2.
const std::string kDry = R"({
  "flotsam": 1, "particle_spacing": 0.1, "duration": 0.4, "time_step": {"max": 0.002},
  "fluids": [{"blocks": [{"min": [0,0,0], "max": [0.3,0.3,0.2]}]}],
  "walls": [{"box": {"min": [0,0,0], "max": [4,4,4], "open": ["+z"]}}],
  "bodies": [{"name": "arm", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [2,2,2]}]
})";
/// Of the box about its middle, the y axis.
constexpr double kInertia = 2.0 / 12.0 * (0.4 * 0.4 + 0.2 * 0.2);

RunReport ran(const std::string& text, const std::vector<std::string>& overrides, const std::filesystem::path& out = {})
{
    Watcher watcher;
    return run_scene(parse_scene(text, "test.json", overrides), {out, 1}, watcher);
}

/// The first joint after a run of kDry: "joints": [{"a": "arm", JOINT}].
JointReport joint_after(const std::string& joint, std::vector<std::string> overrides = {})
{
    overrides.push_back("joints=[{\"a\": \"arm\", " + joint + "}]");
    return ran(kDry, overrides).joints.at(0);
}

/// The first joint as a constraint between two bodies, or in reduced coordinates.
std::string either_way()
{
    return GENERATE("articulations=[]", R"(articulations=[{"joints": ["joint0"]}])");
}

bool has_moved(const RunReport& report, std::size_t body, const Vec3d& from)
{
    return (report.bodies.at(body).position - from).norm() > 0.01;
}

} // namespace

TEST_CASE("a joint bears the weight of the body that hangs from it", "[scene][joint]")
{
    const std::string type =
        GENERATE(R"("type": "hinge", "axis": [0,1,0])", R"("type": "hinge", "axis": [3,0,0])", R"("type": "ball")");
    const std::string way = either_way();
    const JointReport joint = joint_after(type + R"(, "point": [2,2,2.3])", {way});
    INFO(type << " " << way);
    CHECK(joint.force_mean.isApprox(Vec3d(0, 0, 2.0 * kG), 1e-3));
    CHECK(joint.torque_mean.norm() < 1e-3 * 2.0 * kG * 0.3);
    CHECK(std::abs(joint.angle_deg.value()) < 0.01);
    CHECK_FALSE(joint.position);
}

TEST_CASE("a hinge at its limits bears the torque of a cantilever", "[scene][joint]")
{
    // The middle is 0.7 m beside the hinge, towards +x: the weight turns it about +y.
    const std::string axis = GENERATE("[0,1,0]", "[0,-1,0]");
    const JointReport joint =
        joint_after(R"("type": "hinge", "point": [1.3,2,2.1], "limits_deg": [0,0], "axis": )" + axis, {either_way()});
    CHECK(joint.force_mean.isApprox(Vec3d(0, 0, 2.0 * kG), 1e-2));
    CHECK(joint.torque_mean.isApprox(Vec3d(0, -2.0 * kG * 0.7, 0), 1e-2));
    CHECK(std::abs(joint.angle_deg.value()) < 0.1);
}

TEST_CASE("a slider across gravity bears force and torque", "[scene][joint]")
{
    const JointReport joint =
        joint_after(R"("type": "slider", "point": [1.3,2,2], "axis": [0,1,0], "limits": [-0.1,0.1])", {either_way()});
    CHECK(joint.force_mean.isApprox(Vec3d(0, 0, 2.0 * kG), 1e-2));
    CHECK(joint.torque_mean.isApprox(Vec3d(0, -2.0 * kG * 0.7, 0), 1e-2));
    CHECK(std::abs(joint.position.value()) < 1e-4);
    CHECK_FALSE(joint.angle_deg);
}

TEST_CASE("limits stop a body on the side of their sign", "[scene][joint]")
{
    // It falls about +y, or along -z.
    const std::vector<std::string> settings{"duration=1", either_way()};
    const std::string hinge = R"("type": "hinge", "point": [1.3,2,2], "limits_deg": [-20,10], "axis": )";
    CHECK(joint_after(hinge + "[0,1,0]", settings).angle_deg.value() == Approx(10.0).margin(0.1));
    CHECK(joint_after(hinge + "[0,-1,0]", settings).angle_deg.value() == Approx(-20.0).margin(0.1));
    const std::string slider = R"("type": "slider", "point": [2,2,2], "limits": [-0.2,0.1], "axis": )";
    CHECK(joint_after(slider + "[0,0,1]", settings).position.value() == Approx(-0.2).margin(1e-3));
    CHECK(joint_after(slider + "[0,0,-1]", settings).position.value() == Approx(0.1).margin(1e-3));
}

TEST_CASE("motors turn and move a body in the sense of the axis", "[scene][joint]")
{
    const std::string way = either_way();
    const std::vector<std::string> weightless{"gravity=[0,0,0]", way,
                                              R"(joints=[{"a": "arm", "type": "hinge", "point": [2,2,2],
        "axis": [0,-1,0], "motor": {"velocity": 3, "max_torque": 100}}])"};
    const RunReport turned = ran(kDry, weightless);
    CHECK(turned.bodies.at(0).rotation_deg.y() == Approx(-3.0 * 0.4 * kRadian).epsilon(1e-2)); // about -y
    CHECK(turned.joints.at(0).angle_deg.value() == Approx(3.0 * 0.4 * kRadian).epsilon(1e-2));

    const std::vector<std::string> sliding{"gravity=[0,0,0]", way,
                                           R"(joints=[{"a": "arm", "type": "slider", "point": [2,2,2],
        "axis": [0,0,2], "motor": {"velocity": -0.5, "max_force": 1000}}])"};
    const RunReport moved = ran(kDry, sliding);
    CHECK(moved.bodies.at(0).position.z() == Approx(2.0 - 0.5 * 0.4).epsilon(1e-3));
    CHECK(moved.joints.at(0).position.value() == Approx(-0.2).epsilon(1e-2));
}

TEST_CASE("between two free bodies positions are those of a, seen from b", "[scene][joint]")
{
    const std::string bodies = R"(bodies=[
        {"name": "arm", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [2,2,2]},
        {"name": "base", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [1.5,2,2]}])";
    const auto after = [&](const std::string& joint) {
        return ran(kDry, {"gravity=[0,0,0]", bodies, "joints=[{\"a\": \"arm\", \"b\": \"base\", " + joint + "}]"});
    };
    const RunReport turned = after(R"("type": "hinge", "point": [1.75,2,2], "axis": [0,1,0],
        "motor": {"velocity": 1, "max_torque": 100})");
    CHECK(turned.joints.at(0).angle_deg.value() == Approx(0.4 * kRadian).epsilon(1e-2));
    CHECK(turned.bodies.at(0).rotation_deg.y() == Approx(0.2 * kRadian).epsilon(1e-2));
    CHECK(turned.bodies.at(1).rotation_deg.y() == Approx(-0.2 * kRadian).epsilon(1e-2));

    const RunReport moved = after(R"("type": "slider", "point": [1.75,2,2], "axis": [0,1,0],
        "motor": {"velocity": 1, "max_force": 1000})");
    CHECK(moved.joints.at(0).position.value() == Approx(0.4).epsilon(1e-2));
    CHECK((moved.bodies[0].velocity + moved.bodies[1].velocity).norm() < 1e-9);
    CHECK(moved.bodies[0].velocity.norm() > 0.1);
}

TEST_CASE("a motor gives no more than its strength, whatever the step", "[scene][joint]")
{
    const std::string step = GENERATE("time_step.max=0.002", "time_step.max=0.0007"), way = either_way();
    const JointReport hinge = joint_after(R"("type": "hinge", "point": [2,2,2], "axis": [0,1,0],
        "motor": {"velocity": 1000, "max_torque": 0.2})",
                                          {"gravity=[0,0,0]", step, way});
    CHECK(hinge.angle_deg.value() == Approx(0.5 * 0.2 / kInertia * 0.16 * kRadian).epsilon(0.01));
    CHECK(hinge.torque_mean.isApprox(Vec3d(0, 0.2, 0), 1e-6));
    const JointReport slider = joint_after(R"("type": "slider", "point": [2,2,2], "axis": [1,0,0],
        "motor": {"velocity": 100, "max_force": 4})",
                                           {"gravity=[0,0,0]", step, way});
    CHECK(slider.position.value() == Approx(0.5 * 4.0 / 2.0 * 0.16).epsilon(0.01));
    CHECK(slider.force_mean.isApprox(Vec3d(4, 0, 0), 1e-6));
}

TEST_CASE("a motor too weak for its load leaves it at the limit", "[scene][joint]")
{
    // The weight turns about +y with 13.7 N m, the motor about -y with 5.
    const JointReport joint = joint_after(R"("type": "hinge", "point": [1.3,2,2], "limits_deg": [-45,5],
        "axis": [0,1,0], "motor": {"velocity": -3, "max_torque": 5})",
                                          {"duration=1", either_way()});
    CHECK(joint.angle_deg.value() == Approx(5.0).margin(0.1));
    const double arm = 0.7 * std::cos(5.0 / kRadian);
    CHECK(joint.torque_mean.y() == Approx(-2.0 * kG * arm).epsilon(0.01)); // limit and motor together
}

TEST_CASE("a hinge counts its turns", "[scene][joint]")
{
    const JointReport joint = joint_after(R"("type": "hinge", "point": [2,2,2], "axis": [0,0,1],
        "motor": {"velocity": -40, "max_torque": 1000})",
                                          {"gravity=[0,0,0]", "duration=1", either_way()});
    CHECK(joint.angle_deg.value() == Approx(-40.0 * kRadian).epsilon(0.01));
}

TEST_CASE("joints of a heavy body under a light one do not open", "[scene][joint]")
{
    const std::string bodies = R"(bodies=[
        {"name": "link", "shape": {"box": [0.2,0.2,0.4]}, "mass": 1, "position": [2,2,2]},
        {"name": "load", "shape": {"sphere": 0.2}, "mass": 100, "position": [2,2,1.5]}])";
    const std::string joints = R"(joints=[{"type": "ball", "a": "link", "point": [2,2,2.2]},
        {"type": "TYPE", "a": "load", "b": "link", "point": [2,2,1.75], "axis": [0,1,0]}])";
    const std::string way = GENERATE("articulations=[]", R"(articulations=[{"joints": ["joint1", "joint0"]}])");
    const RunReport report = ran(kDry, {bodies, std::string(joints).replace(joints.find("TYPE"), 4, "hinge"), way});
    CHECK(report.bodies.at(0).position.z() == Approx(2.0).margin(5e-4));
    CHECK(report.bodies.at(1).position.z() == Approx(1.5).margin(5e-4)); // a thousandth of the chain
    CHECK(report.joints.at(0).force_mean.z() == Approx(101.0 * kG).epsilon(1e-3));
    CHECK(report.joints.at(1).force_mean.z() == Approx(100.0 * kG).epsilon(1e-3));
}

TEST_CASE("a ball joint lets a body swing and tells the angle", "[scene][joint]")
{
    // A pendulum of 0.5 m let go level: its speed at the bottom is that of its energy.
    const RunReport report = ran(kDry, {"duration=0.35", either_way(),
                                        "joints=[{\"type\": \"ball\", \"a\": \"arm\", "
                                        "\"point\": [1.5,2,2]}]"});
    REQUIRE(has_moved(report, 0, Vec3d(2, 2, 2)));
    const Vec3d arm = report.bodies.at(0).position - Vec3d(1.5, 2, 2);
    CHECK(arm.norm() == Approx(0.5).margin(1e-3));
    CHECK(report.joints.at(0).angle_deg.value() == Approx(std::acos(arm.x() / arm.norm()) * kRadian).margin(0.5));
    const double inertia = kInertia + 2.0 * 0.25, fallen = -arm.z();
    CHECK(report.bodies[0].velocity.norm() == Approx(0.5 * std::sqrt(2.0 * 2.0 * kG * fallen / inertia)).epsilon(0.02));
}

TEST_CASE("bodies that are joined do not collide", "[scene][joint]")
{
    // Two boxes side by side; turned by half a turn about their common edge one is where the other stands.
    const std::string bodies = R"(bodies=[
        {"name": "arm", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [2,2,2]},
        {"name": "base", "shape": {"box": [0.4,0.2,0.2]}, "position": [1.6,2,2], "motion": "fixed"}])";
    const RunReport report = ran(kDry, {bodies, "duration=1", R"(joints=[{"type": "hinge", "a": "arm", "b": "base",
        "point": [1.8,2,2], "axis": [0,1,0], "motor": {"velocity": 3, "max_torque": 1000}}])"});
    CHECK(report.joints.at(0).angle_deg.value() == Approx(3.0 * kRadian).epsilon(0.02));
    CHECK(report.bodies.at(1).position == Vec3d(1.6, 2, 2));
}

TEST_CASE("a body joined to a moving one goes along with it", "[scene][joint]")
{
    const std::string bodies = R"(bodies=[
        {"name": "arm", "shape": {"box": [0.4,0.2,0.2]}, "mass": 2, "position": [2,2,2]},
        {"name": "belt", "shape": {"box": [0.4,0.2,0.2]}, "position": [1.5,2,2], "motion": "moving", "velocity": [0,1,0]}])";
    const RunReport report = ran(kDry, {bodies, "gravity=[0,0,0]", R"(joints=[{"type": "slider", "a": "arm",
        "b": "belt", "point": [1.8,2,2], "axis": [1,0,0]}])"});
    CHECK(report.bodies.at(1).position.y() == Approx(2.4));
    CHECK(report.bodies.at(0).position.y() ==
          Approx(2.4).margin(0.004)); // two steps' way: Bullet moves the other first
    CHECK(report.bodies[0].velocity.y() == Approx(1.0).epsilon(1e-2));
}

TEST_CASE("runs with joints repeat whatever the number of threads", "[scene][joint][determinism]")
{
    const auto hash = [way = either_way()](int threads) {
        Watcher watcher;
        const std::string joint = R"(joints=[{"a": "raft", "type": "hinge", "point": [0.4,0.3], "limits_deg": [-2,2],
            "motor": {"velocity": 1, "max_torque": 5}}])";
        return run_scene(parse_scene(kRaft, "test.json", {joint, way}), {{}, threads}, watcher).state_hash;
    };
    CHECK(hash(1) == hash(3));
}

TEST_CASE("joints in 2-D hold and turn bodies in their plane", "[scene][joint]")
{
    const std::vector<std::string> raft{"bodies.raft.position=[0.5,0.6]", "duration=0.3", either_way()};
    const auto after = [&](const std::string& joint) {
        auto overrides = raft;
        overrides.push_back("joints=[{\"a\": \"raft\", " + joint + "}]");
        return ran(kRaft, overrides).joints.at(0);
    };
    const double weight = 15.0 * kG; // [N/m]
    const JointReport held = after(R"("type": "hinge", "point": [0.35,0.6], "limits_deg": [0,0])");
    CHECK(held.force_mean.isApprox(Vec3d(0, 0, weight), 1e-2));
    CHECK(held.torque_mean.isApprox(Vec3d(0, -weight * 0.15, 0), 1e-2));
    const JointReport ball = after(R"("type": "ball", "point": [0.35,0.6])");
    const JointReport hinge = after(R"("type": "hinge", "point": [0.35,0.6])");
    CHECK(hinge.angle_deg.value() > 10.0); // its free end falls towards +x, about +y
    CHECK(ball.angle_deg.value() == Approx(hinge.angle_deg.value()).epsilon(1e-3));
    const JointReport slider = after(R"("type": "slider", "point": [0.5,0.6], "axis": [1,1], "limits": [-0.05,0.05])");
    CHECK(slider.position.value() == Approx(-0.05).margin(1e-3));
    CHECK(slider.force_mean.isApprox(Vec3d(0, 0, weight), 1e-2));
}

TEST_CASE("joints are in the report and the history", "[scene][joint]")
{
    const TemporaryDirectory directory("flotsam_joints");
    const auto out = directory.path() / "out";
    (void)ran(kRaft,
              {"bodies.raft.position=[0.5,0.6]",
               R"(joints=[{"name": "pin", "type": "hinge", "a": "raft", "point": [0.5,0.6]},
               {"type": "slider", "a": "raft", "point": [0.5,0.6], "axis": [1,0]}])"},
              out);
    const auto json = nlohmann::json::parse(directory.read("out/report.json"));
    REQUIRE(json["joints"].size() == 2);
    CHECK(json["joints"][0]["name"] == "pin");
    CHECK(json["joints"][0]["type"] == "hinge");
    CHECK(json["joints"][0].contains("angle_deg"));
    CHECK(json["joints"][1]["type"] == "slider");
    CHECK(json["joints"][1]["position"].is_number());
    for (const char* key : {"force_mean", "torque_mean"}) CHECK(json["joints"][1][key].size() == 3);

    std::istringstream history(directory.read("out/history.csv"));
    std::string header;
    std::getline(history, header);
    CHECK(header.find(",raft.tz,pin.position,joint1.position,floor,") != std::string::npos);
}
