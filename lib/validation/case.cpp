#include "validation/case.hpp"

#include "flotsam/core/contracts.hpp"
#include "validation/scratch_directory.hpp"
#include "validation/take_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

namespace flotsam::validation {
namespace {

std::vector<std::string> cells(const std::string& line)
{
    std::vector<std::string> parts;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

/// Names of validation bodies have no commas or quotes. Empty cells are NaN.
std::map<std::string, std::vector<double>> read_history(const std::filesystem::path& file)
{
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    const std::vector<std::string> names = cells(line);
    std::map<std::string, std::vector<double>> columns;
    while (std::getline(stream, line)) {
        std::vector<std::string> values = cells(line);
        values.resize(names.size());
        for (std::size_t c = 0; c < names.size(); ++c)
            columns[names[c]].push_back(values[c].empty() ? std::numeric_limits<double>::quiet_NaN()
                                                          : std::strtod(values[c].c_str(), nullptr));
    }
    return columns;
}

/// The last picture of a run, by the names' order; empty where there is none.
std::vector<std::uint8_t> last_picture(const std::filesystem::path& directory)
{
    std::filesystem::path last;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(directory, none)) last = std::max(last, entry.path());
    std::ifstream stream(last, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

RunReport run(std::string_view scene, const std::filesystem::path& out, const ValidationOptions& options)
{
    SilentObserver observer;
    return run_scene(parse_scene(scene, "validation"), {out, options.threads}, observer);
}

} // namespace

RecordedRun run_recorded(std::string_view scene, const ValidationOptions& options)
{
    const ScratchDirectory scratch;
    RecordedRun recorded;
    recorded.report = run(scene, scratch.path() / "run", options);
    recorded.history = read_history(scratch.path() / "run" / "history.csv");
    recorded.png = last_picture(scratch.path() / "run" / "pictures");
    return recorded;
}

RunReport run_unrecorded(std::string_view scene, const ValidationOptions& options)
{
    return run(scene, {}, options);
}

std::string TankScene::text() const
{
    const auto corner = [&](double z) {
        std::ostringstream point;
        point.precision(17);
        point << "[" << width;
        if (dimensions == 3) point << ", " << depth;
        point << ", " << z << "]";
        return point.str();
    };
    const std::string origin = dimensions == 3 ? "[0, 0, 0]" : "[0, 0]";
    std::ostringstream scene;
    scene.precision(17);
    scene << R"({"flotsam": 1, "start": ")" << (starts_at_rest ? "at_rest" : "as_given") << R"(", "dimensions": )"
          << dimensions << R"(, "particle_spacing": )" << spacing << R"(, "duration": )" << duration
          << R"(, "fluids": [{"blocks": [{"min": )" << origin << R"(, "max": )" << corner(level)
          << R"(}]}], "walls": [{"box": {"min": )" << origin << R"(, "max": )" << corner(height)
          << R"(, "open": ["+z"]}}], "bodies": [)" << bodies << R"(], "output": {"frames_per_second": )"
          << frames_per_second;
    if (has_picture)
        scene << R"(, "pictures": {"width": )" << kPictureWidth << R"(, "height": )" << kPictureHeight
              << R"(, "every": )" << std::lround(std::ceil(duration * frames_per_second)) << "}";
    scene << "}}";
    return scene.str();
}

double slope(std::span<const double> x, std::span<const double> y)
{
    FLOTSAM_ASSERT(x.size() == y.size(), "a point has two coordinates");
    const double n = static_cast<double>(x.size());
    double mean_x = 0.0, mean_y = 0.0, above = 0.0, below = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        mean_x += x[k] / n;
        mean_y += y[k] / n;
    }
    for (std::size_t k = 0; k < x.size(); ++k) {
        above += (x[k] - mean_x) * (y[k] - mean_y);
        below += (x[k] - mean_x) * (x[k] - mean_x);
    }
    return above / below;
}

double interpolated(std::span<const double> xs, std::span<const double> ys, double x)
{
    if (xs.size() < 2 || x < xs.front() || x > xs.back()) return std::numeric_limits<double>::quiet_NaN();
    const auto above = std::lower_bound(xs.begin() + 1, xs.end(), x);
    const auto k = static_cast<std::size_t>(above - xs.begin());
    const double part = (x - xs[k - 1]) / (xs[k] - xs[k - 1]);
    return ys[k - 1] + part * (ys[k] - ys[k - 1]);
}

} // namespace flotsam::validation
