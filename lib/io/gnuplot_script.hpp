#pragma once

#include "flotsam/io/plot.hpp"

#include <string>

namespace flotsam {

/// What gnuplot is to read to draw `plot` into `output`, for a terminal of gnuplot's ("pngcairo", "svg").
[[nodiscard]] std::string gnuplot_script(const Plot& plot, const std::string& terminal, const std::string& output);

} // namespace flotsam
