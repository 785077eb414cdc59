#pragma once

#include "cli/arguments.hpp"

#include <CLI/App.hpp>

namespace flotsam::cli {

/// Adds the verb `hydrostatics`.
void add_hydrostatics(CLI::App& app, Arguments& arguments);

/// What is wrong between options of it, or nothing.
[[nodiscard]] std::string fault_between_options(const HydrostaticsRequest& request);

} // namespace flotsam::cli
