#pragma once

#include "scene/read_parts.hpp"

#include <set>
#include <string>

namespace flotsam::scene {

/// "joints" of a scene whose bodies are read. `names` are those taken already; the joints' come to them.
[[nodiscard]] std::vector<SceneJoint> read_joints(const JsonObject& root, const ReadContext& context,
                                                  const std::vector<SceneBody>& bodies, std::set<std::string>& names);

} // namespace flotsam::scene
