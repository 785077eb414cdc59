#include "validation/draw_chart.hpp"

#include "flotsam/io/output_error.hpp"
#include "flotsam/io/plot.hpp"
#include "validation/scratch_directory.hpp"

#include <cmath>
#include <fstream>
#include <iterator>

namespace flotsam::validation {
namespace {

constexpr std::size_t kMostPoints = 30; ///< of what was measured; more of them make a line

PlotSeries series_of(const ValidationCurve& curve)
{
    PlotSeries series;
    series.name = curve.label;
    const bool is_line = curve.kind == ValidationCurve::Kind::reference ||
                         (curve.kind == ValidationCurve::Kind::measured && curve.x.size() > kMostPoints);
    series.style = is_line ? PlotSeries::Style::line : PlotSeries::Style::points;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
        if (!std::isfinite(curve.x[k]) || !std::isfinite(curve.y[k])) continue;
        series.x.push_back(curve.x[k]);
        series.y.push_back(curve.y[k]);
    }
    return series;
}

PlotSeries band_around(const PlotSeries& line, double half_width)
{
    PlotSeries band;
    band.style = PlotSeries::Style::band;
    band.x = line.x;
    for (const double y : line.y) {
        band.y.push_back(y - half_width);
        band.y_upper.push_back(y + half_width);
    }
    return band;
}

} // namespace

std::string svg_of(const ValidationChart& chart)
{
    Plot plot;
    plot.title = chart.title;
    plot.x_label = chart.x_label;
    plot.y_label = chart.y_label;
    plot.height = 560;
    for (const ValidationCurve& curve : chart.curves) {
        const PlotSeries series = series_of(curve);
        if (series.x.empty()) continue;
        if (curve.kind == ValidationCurve::Kind::reference && chart.band > 0.0)
            plot.series.insert(plot.series.begin(), band_around(series, chart.band));
        plot.series.push_back(series);
    }
    if (plot.series.empty()) throw OutputError("nothing of it was measured");
    const ScratchDirectory scratch;
    const std::filesystem::path file = scratch.path() / "chart.svg";
    write_plot(file, plot);
    std::ifstream stream(file);
    const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    const std::size_t start = text.find("<svg"); // after the XML declaration, which has no place in a page
    if (start == std::string::npos) throw OutputError(file.string() + " is no SVG");
    return text.substr(start);
}

} // namespace flotsam::validation
