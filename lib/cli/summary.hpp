#pragma once

#include "flotsam/scene/check_scene.hpp"
#include "flotsam/scene/run_report.hpp"

#include <filesystem>
#include <iosfwd>

namespace flotsam::cli {

/// Numbers of a run, the table of drafts, and where the files are.
void print_summary(std::ostream& out, const RunReport& report, const std::filesystem::path& directory);

/// Notes, sizes and bodies of a scene that can be run.
void print_check(std::ostream& out, const SceneCheck& check, const std::filesystem::path& scene);

/// The same for what `check` found in a mesh file.
void print_check(std::ostream& out, const MeshFileCheck& check, const std::filesystem::path& mesh);

} // namespace flotsam::cli
