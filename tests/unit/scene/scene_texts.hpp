#pragma once

#include "flotsam/core/contracts.hpp"
#include "flotsam/scene/scene_file.hpp"

#include <string>
#include <vector>

namespace flotsam::testing {

/// A small valid 2-D scene: a raft in a tank.
inline const std::string kRaft = R"({
  "flotsam": 1, "dimensions": 2, "particle_spacing": 0.02, "duration": 0.1,
  "fluids": [{"blocks": [{"min": [0, 0], "max": [1, 0.3]}]}],
  "walls": [{"box": {"min": [0, 0], "max": [1, 0.8], "open": ["+z"]}}],
  "bodies": [{"name": "raft", "shape": {"box": [0.3, 0.1]}, "density": 500, "position": [0.5, 0.3]}],
  "probes": [{"name": "floor", "pressure": [0.9, 0.02]}, {"name": "surface", "level": [0.1]}]
})";

/// A small valid 3-D scene: a crate in a tank.
inline const std::string kCrate = R"({
  "flotsam": 1, "particle_spacing": 0.05, "duration": 0.1,
  "fluids": [{"blocks": [{"min": [0, 0, 0], "max": [1, 1, 0.4]}]}],
  "walls": [{"box": {"min": [0, 0, 0], "max": [1, 1, 1], "open": ["+z"]}}],
  "bodies": [{"name": "crate", "shape": {"box": [0.2, 0.2, 0.2]}, "density": 500, "position": [0.5, 0.5, 0.4]}]
})";

inline SceneFile parsed(const std::string& text, const std::vector<std::string>& overrides = {})
{
    return parse_scene(text, "dir/test.json", overrides);
}

/// The sentence with which the call refuses its input; empty when it does not.
template <class Call>
std::string refusal(Call&& call)
{
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

inline std::string refusal_of(const std::string& text, const std::vector<std::string>& overrides = {})
{
    return refusal([&] { (void)parsed(text, overrides); });
}

} // namespace flotsam::testing
