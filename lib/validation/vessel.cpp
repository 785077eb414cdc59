// A boat of sheet metal: what is thinner than a spacing, with water on one side of it and none on the other.
#include "validation/vessel.hpp"

#include "flotsam/io/output_error.hpp"
#include "validation/scratch_directory.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

namespace flotsam::validation {
namespace {

constexpr double kLength = 0.36, kBreadth = 0.24, kHeight = 0.14, kPlate = 0.004; ///< [m]

/// An open box about the middle of its bottom's lower side.
void write_boat(const std::filesystem::path& file)
{
    std::ofstream out(file);
    const auto ring = [&](double inset, double z) {
        for (const auto& [x, y] : {std::array{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
            out << "v " << x * (kLength - 2.0 * inset) << ' ' << y * (kBreadth - 2.0 * inset) << ' ' << z << '\n';
    };
    ring(0.0, 0.0);
    ring(0.0, kHeight);
    ring(kPlate, kHeight);
    ring(kPlate, kPlate);
    out << "f 4 3 2 1\nf 13 14 15 16\n";        // the bottom, from below and from inside
    for (int first = 1; first <= 9; first += 4) // outer sides, rim, inner sides
        for (int k = 0; k < 4; ++k) {
            const int a = first + k, b = first + (k + 1) % 4;
            out << "f " << a << ' ' << b << ' ' << b + 4 << ' ' << a + 4 << '\n';
        }
    out.flush();
    if (!out) throw OutputError("cannot write " + file.string());
}

} // namespace

/// Exact: she displaces her mass, with her hollow. The band is that of the other drafts.
void run_vessel(const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kBand = 0.24; // spacings
    const ScratchDirectory scratch;
    const std::filesystem::path mesh = scratch.path() / "boat.obj";
    write_boat(mesh);
    for (const double resolution : options.quick ? std::vector{12.0} : std::vector{12.0, 16.0}) {
        for (const double draft : {0.04, 0.08}) {
            const double spacing = kBreadth / resolution;
            TankScene tank{.dimensions = 3, .spacing = spacing};
            tank.width = 2.0 * kLength;
            tank.depth = 2.0 * kBreadth;
            tank.level = 0.24;
            tank.height = 0.5;
            tank.duration = 1.5;
            tank.starts_at_rest = true;
            tank.has_picture = draft == 0.08;
            std::ostringstream text;
            text << R"({"name": "boat", "shape": {"mesh": {"file": ")" << mesh.string() << R"("}}, "mass": )"
                 << kWater * kLength * kBreadth * draft << R"(, "position": [)" << 0.5 * tank.width << ", "
                 << 0.5 * tank.depth << ", " << tank.level - 0.5 * draft << "]}";
            tank.bodies = text.str();
            const RecordedRun run = run_recorded(tank.text(), options);
            std::ostringstream quantity;
            quantity << "draft of an open boat, " << 1e3 * draft << " mm";
            result.checks.push_back({quantity.str(), "m", resolution, run.report.bodies.front().draft.value_or(NAN),
                                     draft, kBand * spacing, spacing, run.report.simulated_seconds,
                                     run.report.wall_seconds});
            if (tank.has_picture) result.pictures = {{quantity.str(), run.png}};
        }
    }
}

} // namespace flotsam::validation
