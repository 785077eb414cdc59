#include "scene/read_articulations.hpp"

#include <algorithm>
#include <array>

namespace flotsam::scene {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Bodies of a multibody are moved by its joints alone.
void refuse_unfit_bodies(const JsonNode& node, const SceneJoint& joint, const SceneFile& scene)
{
    for (const std::size_t k : {joint.a, joint.b.value_or(joint.a)}) {
        const SceneBody& body = scene.bodies[k];
        const std::string holds = "holds \"" + body.name + "\", ";
        if (body.motion != SceneBody::Motion::dynamic) node.refuse(holds + "which must be dynamic in an articulation");
        if (std::find(body.lock.begin(), body.lock.end(), true) != body.lock.end())
            node.refuse(holds + "which must have no \"lock\" in an articulation; a joint to the world does it");
    }
}

/// Bodies of an articulation that is being read.
class Tree {
  public:
    Tree(const JsonNode& node, const SceneFile& scene) : node_(node), scene_(scene), holder_(scene.bodies.size(), kNone)
    {
    }
    /// The joint that `a` hangs by.
    void hang(std::size_t joint, const JsonNode& node)
    {
        std::size_t& holder = holder_[scene_.joints[joint].a];
        if (holder != kNone)
            node.refuse("holds \"" + scene_.bodies[scene_.joints[joint].a].name + "\" as \"a\", as \"" +
                        scene_.joints[holder].name +
                        "\" does, and in an articulation each body must be the \"a\" of one joint at most");
        holder = joint;
        joints_.push_back(joint);
    }
    /// From the root on, so that each joint comes after the one that holds its `b`.
    [[nodiscard]] std::vector<std::size_t> in_order() const
    {
        std::vector<std::size_t> order, roots;
        for (const std::size_t joint : joints_) {
            if (hangs_from_root(joint)) order.push_back(joint);
        }
        for (std::size_t k = 0; k < order.size(); ++k)
            for (const std::size_t joint : joints_)
                if (scene_.joints[joint].b == scene_.joints[order[k]].a) order.push_back(joint);
        if (order.size() != joints_.size()) node_.refuse("is a ring of joints, and must be a tree");
        for (const std::size_t joint : order)
            if (hangs_from_root(joint)) refuse_second_root(order.front(), joint);
        return order;
    }

  private:
    [[nodiscard]] bool hangs_from_root(std::size_t joint) const
    {
        const std::optional<std::size_t> b = scene_.joints[joint].b;
        return !b || holder_[*b] == kNone;
    }
    [[nodiscard]] std::string root_of(std::size_t joint) const
    {
        const std::optional<std::size_t> b = scene_.joints[joint].b;
        return b ? "\"" + scene_.bodies[*b].name + "\"" : "the world";
    }
    void refuse_second_root(std::size_t first, std::size_t other) const
    {
        if (scene_.joints[first].b == scene_.joints[other].b) return;
        node_.refuse("hangs from " + root_of(first) + " and from " + root_of(other) +
                     ", and must hang from one of them");
    }

    JsonNode node_;
    const SceneFile& scene_;
    std::vector<std::size_t> holder_; ///< per body of the scene, kNone where it is the `a` of none
    std::vector<std::size_t> joints_;
};

/// What else joins bodies of an articulation would have to be one of its joints.
void refuse_other_joints(const JsonNode& node, const SceneArticulation& articulation, const SceneFile& scene)
{
    const auto is_in = [&](std::size_t body) {
        return std::any_of(articulation.joints.begin(), articulation.joints.end(),
                           [&](std::size_t k) { return scene.joints[k].a == body || scene.joints[k].b == body; });
    };
    for (std::size_t k = 0; k < scene.joints.size(); ++k) {
        if (std::find(articulation.joints.begin(), articulation.joints.end(), k) != articulation.joints.end()) continue;
        const SceneJoint& joint = scene.joints[k];
        for (const std::size_t body : {joint.a, joint.b.value_or(joint.a)})
            if (is_in(body))
                node.refuse("has the body \"" + scene.bodies[body].name + "\", which \"" + joint.name +
                            "\" holds as well; that joint must be one of the articulation's");
    }
}

SceneArticulation read_articulation(const JsonNode& node, const SceneFile& scene, std::vector<bool>& is_taken)
{
    const JsonObject object(node, {"joints"});
    Tree tree(node, scene);
    const std::vector<JsonNode> names = object.required("joints").entries();
    if (names.empty()) object.required("joints").refuse("must name at least one joint");
    for (const JsonNode& name : names) {
        const std::size_t joint = read_number_of_name(name, scene.joints, "joint");
        if (is_taken[joint]) name.refuse_value("must be in one articulation, and once");
        is_taken[joint] = true;
        refuse_unfit_bodies(name, scene.joints[joint], scene);
        tree.hang(joint, name);
    }
    SceneArticulation articulation{tree.in_order()};
    if (scene.dimensions == 2 && scene.joints[articulation.joints.front()].b)
        node.refuse("must hang from the world in two dimensions");
    refuse_other_joints(node, articulation, scene);
    return articulation;
}

} // namespace

std::vector<SceneArticulation> read_articulations(const JsonObject& root, const SceneFile& scene)
{
    std::vector<SceneArticulation> articulations;
    std::vector<bool> is_taken(scene.joints.size(), false);
    for (const JsonNode& node : root.list("articulations"))
        articulations.push_back(read_articulation(node, scene, is_taken));
    return articulations;
}

} // namespace flotsam::scene
