#pragma once

#include "flotsam/validation/validation.hpp"

#include <string>

namespace flotsam::validation {

/// The chart as an svg element for a page: what was measured as points (as a line where there are many), theory as a
/// line with its band, experiments as points. Throws OutputError as write_plot does.
[[nodiscard]] std::string svg_of(const ValidationChart& chart);

} // namespace flotsam::validation
