#pragma once

#include "flotsam/scene/run_scene.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

namespace flotsam::test {

/// Runs a scene given as text, as the program does, without writing results.
inline RunReport run_text(const std::string& text)
{
    const auto file =
        std::filesystem::temp_directory_path() / ("flotsam_scene_" + std::to_string(::getpid()) + ".json");
    std::ofstream(file) << text;
    const SceneFile scene = read_scene(file);
    std::filesystem::remove(file);
    SilentObserver observer;
    return run_scene(scene, {}, observer);
}

} // namespace flotsam::test
