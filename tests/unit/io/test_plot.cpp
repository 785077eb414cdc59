#include "flotsam/io/output_error.hpp"
#include "flotsam/io/plot.hpp"
#include "io/gnuplot_script.hpp"
#include "support/catch.hpp"
#include "unit/io/scratch.hpp"

#include <cstdlib>
#include <limits>

#include <png.h>

using namespace flotsam;

namespace {

Plot sample_plot()
{
    Plot plot;
    plot.title = "Righting arm";
    plot.x_label = "heel [deg]";
    plot.y_label = "GZ [m]";
    plot.series = {{PlotSeries::Style::band, "allowed", {0, 10, 20}, {-1, 0, 1}, {1, 2, 3}},
                   {PlotSeries::Style::line, "exact", {0, 10, 20}, {0, 1, 2}, {}},
                   {PlotSeries::Style::points, "measured", {5, 15}, {0.4, 1.6}, {}}};
    return plot;
}

/// An environment variable for as long as this lives.
class Environment {
  public:
    Environment(const char* name, const std::string& value) : name_(name), old_(std::getenv(name))
    {
        ::setenv(name, value.c_str(), 1);
    }
    ~Environment() { ::setenv(name_, old_.c_str(), 1); }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

  private:
    const char* name_;
    std::string old_;
};

png_image read_header(const std::filesystem::path& file)
{
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&image, file.c_str()) != 0);
    png_image_free(&image);
    return image;
}

/// Pixels of the picture that are near a colour.
int pixels_of_color(const std::filesystem::path& file, int red, int green, int blue)
{
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&image, file.c_str()) != 0);
    image.format = PNG_FORMAT_RGB;
    std::string pixels(PNG_IMAGE_SIZE(image), '\0');
    REQUIRE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) != 0);
    int count = 0;
    for (std::size_t k = 0; k + 2 < pixels.size(); k += 3) {
        const auto channel = [&](std::size_t c) { return static_cast<int>(static_cast<unsigned char>(pixels[k + c])); };
        count += std::abs(channel(0) - red) + std::abs(channel(1) - green) + std::abs(channel(2) - blue) < 30;
    }
    return count;
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("a plot is drawn as PNG in its size, with its lines and points", "[io][plot]")
{
    const Scratch scratch;
    Plot plot = sample_plot();
    plot.width = 800;
    plot.height = 500;
    write_plot(scratch / "plot.png", plot);
    CHECK(scratch.entries() == 1); // script, log and half-written file are gone
    CHECK(read_header(scratch / "plot.png").width == 800);
    CHECK(read_header(scratch / "plot.png").height == 500);
    const int line = pixels_of_color(scratch / "plot.png", 0xD5, 0x5E, 0x00);
    const int points = pixels_of_color(scratch / "plot.png", 0x00, 0x9E, 0x73);
    CHECK(line > 500);
    CHECK(points > 30);

    plot.series.pop_back();
    write_plot(scratch / "plot.png", plot); // the older one is replaced
    CHECK(pixels_of_color(scratch / "plot.png", 0x00, 0x9E, 0x73) < points / 4);
}

TEST_CASE("the ending of the name chooses SVG", "[io][plot]")
{
    const Scratch scratch;
    write_plot(scratch / "plot.svg", sample_plot());
    const std::string svg = contents(scratch / "plot.svg");
    CHECK(contains(svg, "<svg"));
    CHECK(contains(svg, "</svg>"));
    for (const char* text : {"Righting arm", "heel [deg]", "GZ [m]", "allowed", "exact", "measured"})
        CHECK(contains(svg, text));
}

TEST_CASE("texts and names of files are no commands", "[io][plot]")
{
    const Scratch scratch;
    Plot plot = sample_plot();
    const std::string touch = (scratch / "made").string();
    plot.title = "it's '; system 'touch " + touch + "' #\nsystem 'touch " + touch + "'";
    plot.x_label = "`touch " + touch + "` \\";
    plot.y_label = "@x $y {/Bold z} x_1^2";
    plot.series[0].name = "\", system(\"touch " + touch + "\")";
    write_plot(scratch / "it's | a `plot`.svg", plot);
    CHECK(scratch.entries() == 1);
    const std::string svg = contents(scratch / "it's | a `plot`.svg");
    CHECK(contains(svg, "{/Bold z} x_1^2"));
    CHECK(contains(svg, "`touch"));
}

TEST_CASE("numbers in the script have a point and nine digits", "[io][plot]")
{
    Plot plot = sample_plot();
    plot.series = {{PlotSeries::Style::band, "", {1234.56789}, {1e-12}, {-2.5}}};
    const std::string script = gnuplot_script(plot, "svg", "out.svg");
    CHECK(contains(script, "\n1234.56789 1e-12 -2.5\nEND\n"));
    CHECK(contains(script, "notitle"));
}

TEST_CASE("a missing gnuplot is one sentence that names the package", "[io][plot]")
{
    const Scratch scratch;
    const Environment nothing("PATH", (scratch / "empty").string());
    CHECK_THROWS_WITH(write_plot(scratch / "plot.png", sample_plot()),
                      Catch::Contains("plot.png: there is no gnuplot; install the package gnuplot-nox"));
    CHECK_THROWS_AS(write_plot(scratch / "plot.png", sample_plot()), OutputError);
    CHECK(scratch.entries() == 0);
}

TEST_CASE("a gnuplot that fails is quoted, and leaves the older plot", "[io][plot]")
{
    const Scratch scratch;
    put(scratch / "plot.png", "older");
    std::filesystem::create_directory(scratch / "bin");
    put(scratch / "bin/gnuplot", "#!/bin/sh\necho line 1: out of ink >&2\nexit 3\n");
    std::filesystem::permissions(scratch / "bin/gnuplot", std::filesystem::perms::owner_all);
    const Environment fake("PATH", (scratch / "bin").string());
    CHECK_THROWS_WITH(write_plot(scratch / "plot.png", sample_plot()),
                      Catch::Contains("gnuplot failed: line 1: out of ink"));
    CHECK(contents(scratch / "plot.png") == "older");
    CHECK(scratch.entries() == 2);
}

TEST_CASE("a plot that cannot be written is an OutputError", "[io][plot]")
{
    const Scratch scratch;
    CHECK_THROWS_AS(write_plot(scratch / "none/plot.png", sample_plot()), OutputError);
}

TEST_CASE("plots of nothing, of unequal lengths or of no numbers are refused", "[io][plot]")
{
    const Scratch scratch;
    const auto refused = [&](const Plot& plot, const char* name = "plot.png") {
        CHECK_THROWS_AS(write_plot(scratch / name, plot), std::invalid_argument);
    };
    refused(sample_plot(), "plot.pdf");
    refused(sample_plot(), "plot");
    Plot plot = sample_plot();
    plot.width = 99;
    refused(plot);
    plot = sample_plot();
    plot.series.clear();
    refused(plot);
    plot = sample_plot();
    plot.series[1] = {};
    refused(plot);
    plot = sample_plot();
    plot.series[1].y.pop_back();
    refused(plot);
    plot = sample_plot();
    plot.series[0].y_upper.pop_back();
    refused(plot);
    plot = sample_plot();
    plot.series[1].y_upper = plot.series[1].y;
    refused(plot);
    plot = sample_plot();
    plot.series[2].x[0] = std::numeric_limits<double>::quiet_NaN();
    refused(plot);
    CHECK(scratch.entries() == 0);
}
