#include "scene_texts.hpp"
#include "support/catch.hpp"

#include <numbers>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A crate, a post that stands still and a belt that moves.
SceneFile with_joints(const std::string& joints, const std::string& more = "")
{
    return parsed(kCrate, {R"(bodies=[{"name":"crate","shape":{"sphere":0.1},"mass":1},
        {"name":"hull","shape":{"sphere":0.1},"mass":1},
        {"name":"post","shape":{"sphere":0.1},"motion":"fixed"},
        {"name":"belt","shape":{"sphere":0.1},"motion":"moving","velocity":[1,0,0]}])",
                           "joints=" + joints, more.empty() ? "duration=0.1" : more});
}

/// Whether a joint `{"type": ..., ...}` is refused with a sentence that has all parts.
void check_refused(const std::string& joints, const std::vector<std::string>& parts)
{
    const std::string sentence = refusal([&] { (void)with_joints(joints); });
    INFO(joints << " gives: " << sentence);
    CHECK(sentence.find("test.json: ") != std::string::npos);
    for (const std::string& part : parts) CHECK(sentence.find(part) != std::string::npos);
}

} // namespace

TEST_CASE("every key of a joint is read", "[scene][joint]")
{
    const SceneFile scene = with_joints(R"([
        {"name": "axle", "type": "hinge", "a": "crate", "b": "hull", "point": [1,2,3], "axis": [0,5,0],
         "limits_deg": [-30,45], "motor": {"velocity": -3, "max_torque": 2}},
        {"type": "slider", "a": "post", "b": "crate", "point": [0,0,1], "axis": [0,3,4], "limits": [-0.1,0],
         "motor": {"velocity": 1, "max_force": 5}},
        {"type": "ball", "a": "hull", "point": [0,0,0]}])");
    REQUIRE(scene.joints.size() == 3);
    const SceneJoint &hinge = scene.joints[0], &slider = scene.joints[1], &ball = scene.joints[2];
    CHECK(hinge.name == "axle");
    CHECK(hinge.type == SceneJoint::Type::hinge);
    CHECK(hinge.a == 0);
    CHECK(hinge.b == std::size_t{1});
    CHECK(hinge.point == Vec3d(1, 2, 3));
    CHECK(hinge.axis == Vec3d(0, 1, 0));
    CHECK(hinge.limits->low == Approx(-30.0 * kDegree));
    CHECK(hinge.limits->high == Approx(45.0 * kDegree));
    CHECK(hinge.motor->velocity == -3.0);
    CHECK(hinge.motor->strength == 2.0);
    CHECK(slider.name == "joint1");
    CHECK(slider.axis.isApprox(Vec3d(0, 0.6, 0.8)));
    CHECK(slider.limits->low == -0.1);
    CHECK(slider.limits->high == 0.0);
    CHECK(slider.motor->strength == 5.0);
    CHECK(ball.name == "joint2");
    CHECK_FALSE(ball.b);
    CHECK_FALSE(ball.limits);
    CHECK_FALSE(ball.motor);
}

TEST_CASE("joints in 2-D turn about y", "[scene][joint]")
{
    const auto joint = [](const std::string& text) {
        return parsed(kRaft, {"joints=[{\"a\": \"raft\", \"point\": [1, 2], " + text + "}]"}).joints.at(0);
    };
    CHECK(joint(R"("type": "hinge")").axis == Vec3d(0, 1, 0));
    CHECK(joint(R"("type": "hinge", "axis": [0,-2,0])").axis == Vec3d(0, -1, 0));
    CHECK(joint(R"("type": "ball")").axis == Vec3d(0, 1, 0));
    CHECK(joint(R"("type": "slider", "axis": [0,-2])").axis == Vec3d(0, 0, -1));
    CHECK(joint(R"("type": "hinge")").point == Vec3d(1, 0, 2));
    const std::string sentence = refusal([&] { (void)joint(R"("type": "hinge", "axis": [0,1,1])"); });
    CHECK(sentence.find("joints[0].axis must be [0, 1, 0] or [0, -1, 0]") != std::string::npos);
    CHECK_FALSE(refusal([&] { (void)joint(R"("type": "slider")"); }).empty());
    CHECK_FALSE(refusal([&] { (void)joint(R"("type": "slider", "axis": [0,1,1])"); }).empty());
}

TEST_CASE("bad joints are refused with the place and what is allowed", "[scene][joint]")
{
    struct Case {
        const char* joint; ///< beside a, point and axis
        std::vector<std::string> parts;
    };
    const Case each = GENERATE(values<Case>({
        {R"("type": "hing")", {"joints[0].type must be", "the nearest is \"hinge\", given \"hing\""}},
        {R"("type": "hinge", "b": "hul")", {"joints[0].b must be the name of a body", "nearest is \"hull\""}},
        {R"("type": "hinge", "b": "crate")", {"joints[0] joins body \"crate\" to itself"}},
        {R"("type": "hinge", "limits_deg": [30, -30])", {"joints[0].limits_deg must be [low, high]", "[30,-30]"}},
        {R"("type": "hinge", "limits_deg": [10, 30])", {"joints[0].limits_deg must have 0 between them"}},
        {R"("type": "hinge", "limits_deg": [-200, 30])", {"joints[0].limits_deg[0]", "from -180 to 180 [degrees]"}},
        {R"("type": "hinge", "limits_deg": 30)", {"joints[0].limits_deg", "the 2 limits [low, high] [degrees]"}},
        {R"("type": "hinge", "limits": [0, 1])", {"joints[0].limits is for sliders", "\"limits_deg\""}},
        {R"("type": "slider", "limits_deg": [0, 1])", {"joints[0].limits_deg is for hinges", "\"limits\""}},
        {R"("type": "slider", "limits": [1, 0])", {"joints[0].limits must be [low, high]"}},
        {R"("type": "hinge", "motor": {"velocity": 1})", {"joints[0].motor lacks the required key \"max_torque\""}},
        {R"("type": "hinge", "motor": {"max_torque": 1})", {"joints[0].motor lacks the required key \"velocity\""}},
        {R"("type": "hinge", "motor": {"velocity": 1, "max_torque": -2})", {"motor.max_torque", "> 0 [N m]", "-2"}},
        {R"("type": "hinge", "motor": {"velocity": 1, "max_force": 2})", {"max_force is an unknown key", "max_torque"}},
        {R"("type": "slider", "motor": {"velocity": 1, "max_force": 0})", {"motor.max_force", "> 0 [N]"}},
        {R"("type": "hinge", "colour": 3)", {"joints[0].colour is an unknown key"}},
        {R"("type": "hinge", "name": "")", {"joints[0].name must be a text"}},
        {R"("type": "hinge", "name": "hull")", {"joints[0].name must differ from the names of all other"}},
        {R"("type": "hinge", "name": "a,b")", {"joints[0].name must be free of commas"}},
    }));
    check_refused(R"([{"a": "crate", "point": [0,0,0], "axis": [0,0,1], )" + std::string(each.joint) + "}]",
                  each.parts);
}

TEST_CASE("what a joint needs or must not have is said", "[scene][joint]")
{
    const std::string ends = R"("a": "crate", "point": [0,0,0])";
    check_refused(R"([{"type": "hinge", "point": [0,0,0], "axis": [0,0,1]}])", {"joints[0] lacks", "\"a\""});
    check_refused(R"([{"type": "hinge", "a": "crate", "axis": [0,0,1]}])", {"joints[0] lacks", "\"point\""});
    check_refused("[{\"type\": \"hinge\", " + ends + "}]", {"joints[0] lacks", "\"axis\""});
    check_refused("[{\"type\": \"slider\", " + ends + "}]", {"joints[0] lacks", "\"axis\""});
    check_refused("[{" + ends + "}]", {"joints[0] lacks", "\"type\""});
    check_refused("[{\"type\": \"hinge\", \"axis\": [0,0,0], " + ends + "}]", {"joints[0].axis must be longer than 0"});
    for (const char* key : {"\"limits\": [0,1]", "\"limits_deg\": [0,1]", "\"axis\": [0,0,1]",
                            "\"motor\": {\"velocity\": 1, \"max_torque\": 1}"})
        check_refused("[{\"type\": \"ball\", " + ends + ", " + key + "}]", {"a ball joint has none"});
    check_refused(R"([{"type": "ball", "a": "post", "point": [0,0,0]}])", {"joins \"post\" to the world", "dynamic"});
    check_refused(R"([{"type": "ball", "a": "post", "b": "belt", "point": [0,0,0]}])",
                  {"joints[0] joins \"post\" and \"belt\", one of which must be dynamic"});
    check_refused("[{\"type\": \"ball\", \"name\": \"j\", " + ends + "}, {\"type\": \"ball\", \"name\": \"j\", " +
                      ends + "}]",
                  {"joints[1].name must differ", "given \"j\""});
    check_refused("[{\"type\": \"ball\", \"name\": \"joint1\", " + ends + "}, {\"type\": \"ball\", " + ends + "}]",
                  {"joints[1] has no name", "\"joint1\""});
    const std::string no_bodies = refusal_of(kCrate, {"bodies=[]", "joints=[{\"type\": \"ball\", " + ends + "}]"});
    CHECK(no_bodies.find("the scene has none") != std::string::npos);
}

TEST_CASE("a value of a joint can be set", "[scene][joint]")
{
    const std::string joint = R"([{"name": "axle", "type": "hinge", "a": "crate", "point": [0,0,0], "axis": [0,0,1]}])";
    CHECK(with_joints(joint, "joints.axle.axis=[0,1,0]").joints.at(0).axis == Vec3d(0, 1, 0));
}
