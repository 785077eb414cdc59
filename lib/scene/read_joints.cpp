#include "scene/read_joints.hpp"

#include <algorithm>
#include <numbers>

namespace flotsam::scene {
namespace {

using Type = SceneJoint::Type;

constexpr double kDegree = std::numbers::pi / 180.0;

Type read_type(const JsonNode& node)
{
    const std::vector<std::string> words{"hinge", "slider", "ball"};
    const std::string word = node.text();
    const auto found = std::find(words.begin(), words.end(), word);
    if (found == words.end())
        node.refuse_value("must be \"hinge\", \"slider\" or \"ball\", the nearest is \"" + nearest_word(word, words) +
                          "\"");
    return std::array{Type::hinge, Type::slider, Type::ball}[static_cast<std::size_t>(found - words.begin())];
}

void read_bodies(const JsonObject& object, const std::vector<SceneBody>& bodies, SceneJoint& joint)
{
    joint.a = read_number_of_name(object.required("a"), bodies, "body");
    if (const auto b = object.find("b")) joint.b = read_number_of_name(*b, bodies, "body");
    const auto is_dynamic = [&](std::size_t k) { return bodies[k].motion == SceneBody::Motion::dynamic; };
    if (joint.a == joint.b)
        object.node().refuse("joins body \"" + bodies[joint.a].name + "\" to itself, and must join two bodies");
    if (is_dynamic(joint.a) || (joint.b && is_dynamic(*joint.b))) return;
    if (!joint.b)
        object.node().refuse("joins \"" + bodies[joint.a].name + "\" to the world, and must join a dynamic body to it");
    object.node().refuse("joins \"" + bodies[joint.a].name + "\" and \"" + bodies[*joint.b].name +
                         "\", one of which must be dynamic");
}

/// Keys that belong to another type of joint.
void refuse_foreign_keys(const JsonObject& object, Type type)
{
    const auto refuse = [&](const char* key, const char* what) {
        if (object.has(key)) object.required(key).refuse(what);
    };
    if (type == Type::hinge) refuse("limits", "is for sliders; those of a hinge are \"limits_deg\"");
    if (type == Type::slider) refuse("limits_deg", "is for hinges; those of a slider are \"limits\"");
    if (type != Type::ball) return;
    for (const char* key : {"axis", "limits", "limits_deg", "motor"})
        refuse(key, "is for hinges and sliders; a ball joint has none");
}

/// In 2-D all turning is about y.
Vec3d read_axis(const JsonObject& object, const ReadContext& context, Type type)
{
    const bool in_plane = context.dimensions == 2;
    if (in_plane && type != Type::slider && !object.has("axis")) return Vec3d::UnitY();
    if (type == Type::ball) return Vec3d::Zero();
    const JsonNode node = object.required("axis");
    const ReadContext space{in_plane && type == Type::slider ? 2 : 3, context.folder};
    const Vec3d axis = read_vector(node, space);
    if (in_plane && type == Type::hinge && (axis.x() != 0.0 || axis.z() != 0.0))
        node.refuse_value("must be [0, 1, 0] or [0, -1, 0] in two dimensions, where all turning is about y");
    if (!(axis.norm() > 1e-9)) node.refuse_value("must be longer than 0");
    return axis.normalized();
}

/// The scene starts at 0, which limits must allow.
std::optional<SceneJoint::Limits> read_limits(const JsonObject& object, Type type)
{
    const bool turns = type == Type::hinge;
    const auto node = object.find(turns ? "limits_deg" : "limits");
    if (!node) return {};
    const Allowed allowed{.unit = turns ? "degrees" : "m", .most = turns ? 180.0 : 1e9};
    const std::vector<double> v = node->numbers({2}, "the 2 limits [low, high]", allowed);
    if (!(v[0] <= v[1])) node->refuse_value("must be [low, high], low no larger than high");
    if (!(v[0] <= 0.0 && v[1] >= 0.0))
        node->refuse_value("must have 0 between them, the pose in which the scene starts");
    const double unit = turns ? kDegree : 1.0;
    return SceneJoint::Limits{v[0] * unit, v[1] * unit};
}

std::optional<SceneJoint::Motor> read_motor(const JsonObject& object, Type type)
{
    const auto node = object.find("motor");
    if (!node) return {};
    if (type == Type::hinge) {
        const JsonObject motor(*node, {"velocity", "max_torque"});
        return SceneJoint::Motor{motor.required("velocity").number({.unit = "rad/s", .most = 1e4}),
                                 motor.required("max_torque").number({Allowed::Range::positive, "N m"})};
    }
    const JsonObject motor(*node, {"velocity", "max_force"});
    return SceneJoint::Motor{motor.required("velocity").number(kSpeed),
                             motor.required("max_force").number({Allowed::Range::positive, "N"})};
}

SceneJoint read_joint(const JsonNode& node, const ReadContext& context, const std::vector<SceneBody>& bodies)
{
    const JsonObject object(node, {"name", "type", "a", "b", "point", "axis", "limits_deg", "limits", "motor"});
    SceneJoint joint;
    if (const auto name = object.find("name")) joint.name = name->text();
    joint.type = read_type(object.required("type"));
    refuse_foreign_keys(object, joint.type);
    read_bodies(object, bodies, joint);
    joint.point = read_vector(object.required("point"), context, {.unit = "m"});
    joint.axis = read_axis(object, context, joint.type);
    joint.limits = read_limits(object, joint.type);
    joint.motor = read_motor(object, joint.type);
    return joint;
}

} // namespace

std::vector<SceneJoint> read_joints(const JsonObject& root, const ReadContext& context,
                                    const std::vector<SceneBody>& bodies, std::set<std::string>& names)
{
    std::vector<SceneJoint> joints;
    for (const JsonNode& node : root.list("joints")) {
        SceneJoint joint = read_joint(node, context, bodies);
        if (!joint.name.empty()) {
            add_name(names, joint.name, node);
        } else {
            joint.name = "joint" + std::to_string(joints.size());
            if (!names.insert(joint.name).second)
                node.refuse("has no name and cannot be called \"" + joint.name + "\", which is another's; give it one");
        }
        joints.push_back(std::move(joint));
    }
    return joints;
}

} // namespace flotsam::scene
