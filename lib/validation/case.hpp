#pragma once

#include "flotsam/scene/run_scene.hpp"
#include "flotsam/validation/validation.hpp"

#include <chrono>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flotsam::validation {

constexpr double kGravity = 9.81, kWater = 1000.0; ///< [m/s^2], [kg/m^3]

class Stopwatch {
  public:
    [[nodiscard]] double seconds() const
    {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A case as the list of cases has it. `run` fills checks, charts and notes.
struct Case {
    const char* name;
    const char* group;
    const char* title;
    double quick_limit; ///< [s] on two cores; 0: not part of a quick run
    double full_limit;  ///< [s]
    void (*run)(const ValidationOptions&, ValidationResult&);
};

// One list for each group.
[[nodiscard]] std::span<const Case> static_cases();       // statics.cpp
[[nodiscard]] std::span<const Case> coupled_cases();      // coupled_motion.cpp
[[nodiscard]] std::span<const Case> fluid_cases();        // fluid_alone.cpp
[[nodiscard]] std::span<const Case> conservation_cases(); // conservation.cpp

/// What a run of a scene left: its report, the columns of its history.csv and the last of its pictures.
struct RecordedRun {
    RunReport report;
    std::map<std::string, std::vector<double>> history;
    std::vector<std::uint8_t> png; ///< empty where the scene asks for no pictures

    [[nodiscard]] const std::vector<double>& column(const std::string& name) const { return history.at(name); }
};

/// Runs a scene text as the program does, in a temporary directory.
[[nodiscard]] RecordedRun run_recorded(std::string_view scene, const ValidationOptions& options);

/// The same without its history.
[[nodiscard]] RunReport run_unrecorded(std::string_view scene, const ValidationOptions& options);

/// Scene text of a tank with a corner at the origin, open above, filled up to `level`, with `bodies`: the inside of the
/// scene's list.
struct TankScene {
    int dimensions = 2;
    double spacing = 0.0, width = 0.0, depth = 0.0, level = 0.0,
           height = 0.0; ///< [m]; depth: along y, of no effect in 2-D
    double duration = 0.0, frames_per_second = 30.0;
    bool starts_at_rest = false;
    bool has_picture = false; ///< of its end
    std::string bodies{};

    [[nodiscard]] std::string text() const;
};

/// Slope of the line through the points by least squares.
[[nodiscard]] double slope(std::span<const double> x, std::span<const double> y);

/// Value at `x` on the line through the points to both sides; `xs` rises.
[[nodiscard]] double interpolated(std::span<const double> xs, std::span<const double> ys, double x);

} // namespace flotsam::validation
