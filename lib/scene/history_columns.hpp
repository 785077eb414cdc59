#pragma once

#include "flotsam/scene/scene_file.hpp"

#include <string>
#include <vector>

namespace flotsam::scene {

/// Names of the columns of history.csv: `t`, 18 of each body, one of each joint and of each probe.
[[nodiscard]] std::vector<std::string> history_columns(const SceneFile& scene);

} // namespace flotsam::scene
