#pragma once

#include "flotsam/scene/hydrostatics_report.hpp"

#include <filesystem>
#include <iosfwd>

namespace flotsam::cli {

/// How the body floats as it is modelled, its stable poses, its righting arms, and where the files are.
void print_hydrostatics(std::ostream& out, const HydrostaticsReport& report, const std::filesystem::path& directory);

} // namespace flotsam::cli
