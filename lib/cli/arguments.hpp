#pragma once

#include "flotsam/scene/hydrostatics_report.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flotsam::cli {

struct Arguments {
    enum class Verb { run, check, hydrostatics, validate } verb = Verb::run;
    std::filesystem::path scene;      ///< or the mesh
    std::filesystem::path out;        ///< default: out/SCENE, out/MESH-hydrostatics, out/validation
    HydrostaticsRequest hydrostatics; ///< of the verb of that name
    std::vector<std::string> overrides;
    int threads = 0;
    bool quiet = false;
    std::vector<std::string> cases; ///< of validate; empty: all
    bool quick = false;             ///< of validate
};

/// What the command line asks for; or, where it asks for help or is wrong, what to exit with after having said so.
struct Parsed {
    std::optional<Arguments> arguments;
    int exit_code = 0;
};
[[nodiscard]] Parsed parse_arguments(int argc, char** argv);

} // namespace flotsam::cli
