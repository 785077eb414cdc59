#pragma once

#include "cli/arguments.hpp"

#include <iosfwd>

namespace flotsam::cli {

/// Runs the cases that were asked for, prints a line for each check and writes the report. Returns how many checks lie
/// outside their bands. Throws InputError for the name of a case that there is none of.
[[nodiscard]] int validate(std::ostream& stream, const Arguments& arguments);

} // namespace flotsam::cli
