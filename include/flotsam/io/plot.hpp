#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flotsam {

/// Numbers that are drawn together in one colour.
struct PlotSeries {
    enum class Style { line, points, band } style = Style::line;
    std::string name;            ///< in the key; empty: not in it
    std::vector<double> x;       ///< ascending for a line or a band, unless it is meant to turn back
    std::vector<double> y;       ///< one per x; the lower edge of a band
    std::vector<double> y_upper; ///< the upper edge of a band, one per x; else empty
};

/// One pair of axes. Texts are drawn as they are, a line each.
struct Plot {
    std::string title;
    std::string x_label; ///< with its unit
    std::string y_label; ///< likewise
    std::vector<PlotSeries> series;
    int width = 1000; ///< [pixels], 100 to 10000
    int height = 640; ///< likewise
};

/// Draws a plot with gnuplot (Debian's gnuplot-nox), which is run as a program on a script; no shell is involved, and
/// the user's own gnuplot settings are not read. `file` ends in .png or .svg and appears whole or not at all.
/// Throws OutputError where gnuplot is missing (naming the package), fails, or the file cannot be written;
/// std::invalid_argument for another ending, no series, series without points or of unequal lengths, numbers that are
/// not finite, a size out of bounds.
void write_plot(const std::filesystem::path& file, const Plot& plot);

} // namespace flotsam
