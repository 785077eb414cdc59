#pragma once

#include "scene/prepared_scene.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace flotsam::scene {

/// The gap between two walls that are tanks of their own [m], as parted_by has it; nothing for others.
[[nodiscard]] std::optional<double> gap_of_tanks(const SceneFile& scene, std::size_t a, std::size_t b);

/// Numbers of the box walls that bound each tank, in rising order: one tank of all, unless closed sides part them.
[[nodiscard]] std::vector<std::vector<std::size_t>> tanks_of_boxes(const SceneFile& scene);

/// Refuses tanks so close to each other that the water of one would feel the wall of the other, by an InputError.
void check_gaps_of_tanks(const SceneFile& scene, const PreparedScene& prepared);

} // namespace flotsam::scene
