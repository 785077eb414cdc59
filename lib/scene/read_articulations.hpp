#pragma once

#include "scene/read_parts.hpp"

#include <vector>

namespace flotsam::scene {

/// Reads `articulations` of a scene whose bodies and joints are read.
[[nodiscard]] std::vector<SceneArticulation> read_articulations(const JsonObject& root, const SceneFile& scene);

} // namespace flotsam::scene
