#include "io/gnuplot_script.hpp"

#include "io/number_text.hpp"

#include <array>

namespace flotsam {
namespace {

/// Colours that colour-blind people tell apart. **Source:** Okabe & Ito 2008.
constexpr std::array<const char*, 6> kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};

/// In single quotes gnuplot takes everything as it is but the quote itself, which is doubled.
std::string quoted(const std::string& text)
{
    std::string result = "'";
    for (const char c : text) {
        if (c == '\'') result += '\'';
        result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return result + '\'';
}

void append_data(std::string& script, std::size_t number, const PlotSeries& series)
{
    script += "$series" + std::to_string(number) + " << END\n";
    for (std::size_t k = 0; k < series.x.size(); ++k) {
        append_number(script, series.x[k]);
        script += ' ';
        append_number(script, series.y[k]);
        if (series.style == PlotSeries::Style::band) {
            script += ' ';
            append_number(script, series.y_upper[k]);
        }
        script += '\n';
    }
    script += "END\n";
}

std::string style_words(PlotSeries::Style style, const std::string& color)
{
    switch (style) {
    case PlotSeries::Style::line:
        return "using 1:2 with lines linewidth 2 linecolor rgb '" + color + "'";
    case PlotSeries::Style::points:
        return "using 1:2 with points pointtype 7 pointsize 0.8 linecolor rgb '" + color + "'";
    case PlotSeries::Style::band:
        return "using 1:2:3 with filledcurves fillcolor rgb '" + color + "' fillstyle transparent solid 0.25 noborder";
    }
    return {};
}

std::string key_words(const std::string& name)
{
    return name.empty() ? std::string("notitle") : "title " + quoted(name);
}

} // namespace

std::string gnuplot_script(const Plot& plot, const std::string& terminal, const std::string& output)
{
    std::string script = "set terminal " + terminal + " noenhanced size " + std::to_string(plot.width) + "," +
                         std::to_string(plot.height) + "\nset output " + quoted(output) + "\nset encoding utf8\n";
    script += "set title " + quoted(plot.title) + "\nset xlabel " + quoted(plot.x_label) + "\nset ylabel " +
              quoted(plot.y_label) + "\nset grid linecolor rgb '#DDDDDD'\nset xzeroaxis linetype -1\n";
    script += "set key outside bottom center horizontal\nset offsets graph 0.02, graph 0.02, graph 0.03, graph 0.03\n";
    for (std::size_t k = 0; k < plot.series.size(); ++k) append_data(script, k, plot.series[k]);
    script += "plot ";
    for (std::size_t k = 0; k < plot.series.size(); ++k) {
        if (k > 0) script += ", \\\n     ";
        const PlotSeries& series = plot.series[k];
        script += "$series" + std::to_string(k) + " " + style_words(series.style, kColors[k % kColors.size()]) + " " +
                  key_words(series.name);
    }
    return script + "\nset output\n";
}

} // namespace flotsam
