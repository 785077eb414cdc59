#pragma once

#include "flotsam/scene/scene_file.hpp"
#include "scene/strict_json.hpp"

#include <algorithm>
#include <set>
#include <string>

namespace flotsam::scene {

/// What the parts of a scene need to know of the whole.
struct ReadContext {
    int dimensions = 3;
    std::filesystem::path folder; ///< relative file names count from here
};

[[nodiscard]] SceneBody read_body(const JsonNode& node, const ReadContext& context);
[[nodiscard]] SceneWall read_wall(const JsonNode& node, const ReadContext& context);
[[nodiscard]] SceneOutput read_output(const JsonNode& node, const ReadContext& context);

/// What is faster is no water; a unit was misread.
inline constexpr Allowed kSpeed{.unit = "m/s", .most = 1000.0};

/// Adds the "name" of a node to those of the scene, all of which must differ.
void add_name(std::set<std::string>& names, const std::string& name, const JsonNode& node);

/// Number of the part of the scene (`what`: body or joint) whose name the node is; refuses what is none's.
template <class Part>
[[nodiscard]] std::size_t read_number_of_name(const JsonNode& node, const std::vector<Part>& parts, const char* what)
{
    const std::string name = node.text(), must = std::string("must be the name of a ") + what;
    std::vector<std::string> names;
    for (const Part& part : parts) names.push_back(part.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (names.empty()) node.refuse_value(must + ", and the scene has none");
    if (found == names.end()) node.refuse_value(must + ", the nearest is \"" + nearest_word(name, names) + "\"");
    return static_cast<std::size_t>(found - names.begin());
}

/// [x, y, z]; in 2-D also [x, z], and y must be 0.
[[nodiscard]] Vec3d read_vector(const JsonNode& node, const ReadContext& context, Allowed allowed = {});
/// "min" and "max" of an object, each coordinate of max above that of min. In 2-D y goes from -1/2 to 1/2 m, so that
/// volumes are per metre of width.
[[nodiscard]] Aabb read_box(const JsonObject& object, const ReadContext& context);
/// "position" and "rotation_deg" of an object, each of which may be missing.
[[nodiscard]] Pose read_pose(const JsonObject& object, const ReadContext& context);
/// "file", "scale" and "up" of an object.
[[nodiscard]] SceneMesh read_mesh(const JsonObject& object, const ReadContext& context);

} // namespace flotsam::scene
