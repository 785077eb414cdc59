#pragma once

#include "flotsam/core/contracts.hpp"
#include "flotsam/scene/scene_file.hpp"

#include <sstream>

namespace flotsam::scene {

/// Throws an InputError "FILE: WORDS".
template <class... Words>
[[noreturn]] void refuse(const SceneFile& scene, const Words&... words)
{
    std::ostringstream sentence;
    sentence << scene.file.string() << ": ";
    (sentence << ... << words);
    throw InputError(sentence.str());
}

} // namespace flotsam::scene
