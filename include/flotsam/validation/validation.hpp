#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flotsam {

/// One number that theory or experiment knows, as the simulation has it.
struct ValidationCheck {
    std::string quantity;            ///< what was measured, with its parameters; the same at each resolution
    std::string unit;                ///< of value, reference and tolerance
    double resolution = 0.0;         ///< size / particle spacing
    double value = 0.0;              ///< measured; NaN: the run did not get to it
    double reference = 0.0;          ///< by theory or experiment
    double tolerance = 0.0;          ///< half width of the band around `reference`
    std::optional<double> spacing{}; ///< of the particles [m], where the quantity is a length
    double simulated_seconds = 0.0;
    double wall_seconds = 0.0;

    [[nodiscard]] double error() const { return value - reference; }
    [[nodiscard]] bool passed() const { return std::abs(error()) <= tolerance; } ///< false for NaN
    /// error() as a part of the reference; nothing where that is zero (to a millionth of the band).
    [[nodiscard]] std::optional<double> relative_error() const
    {
        if (std::abs(reference) <= 1e-6 * tolerance) return std::nullopt;
        return error() / std::abs(reference);
    }
};

/// Points of a chart.
struct ValidationCurve {
    enum class Kind { measured, reference, experiment };
    std::string label;
    Kind kind = Kind::measured;
    std::vector<double> x, y;
};

struct ValidationChart {
    std::string title, x_label, y_label;
    std::vector<ValidationCurve> curves;
    double band = 0.0; ///< half width of the band around the curves of the reference, in y; 0: none
};

/// What a case looked like.
struct ValidationPicture {
    std::string caption;
    std::vector<std::uint8_t> png; ///< bytes of the file
};

struct ValidationResult {
    std::string name, group, title;
    double time_limit = 0.0;   ///< on two cores [s]
    double wall_seconds = 0.0; ///< that it took
    std::vector<ValidationCheck> checks;
    std::vector<ValidationChart> charts;
    std::vector<ValidationPicture> pictures;
    std::vector<std::string> notes; ///< what the numbers do not say, a sentence each

    [[nodiscard]] bool passed() const;
};

struct ValidationOptions {
    bool quick = false; ///< coarser, and fewer of them
    int threads = 0;    ///< 0: all the machine has
};

struct ValidationCaseInfo {
    std::string name, group, title;
    double time_limit = 0.0; ///< on two cores [s]
    bool is_quick = false;   ///< part of a quick run
};

/// All cases, in the order in which they run.
[[nodiscard]] std::vector<ValidationCaseInfo> validation_cases(bool quick);

/// Runs one of them. Throws std::invalid_argument for a name that is none; RunFailure when a simulation comes apart.
[[nodiscard]] ValidationResult run_validation_case(const std::string& name, const ValidationOptions& options);

/// Order of convergence of each check that was made at several resolutions: the slope of log |error| over
/// log resolution, by least squares, negated; nothing where fewer than two errors differ from zero.
[[nodiscard]] std::optional<double> order_of_convergence(const ValidationResult& result, const std::string& quantity);

/// What came out of the cases so far, in a directory that is made if need be: validation.csv, a row for each check, and
/// report.html, one page with tables, pictures and charts that needs no other file. Each chart is drawn once.
class ValidationReport {
  public:
    /// Makes the directory if it is not there; throws InputError where it cannot.
    ValidationReport(std::filesystem::path directory, const ValidationOptions& options);
    /// Adds a case and writes both files anew. Throws OutputError.
    void add(const ValidationResult& result);

  private:
    std::filesystem::path directory_;
    ValidationOptions options_;
    std::vector<ValidationResult> results_;
    std::vector<std::string> sections_; ///< of the page, one per result
};

} // namespace flotsam
