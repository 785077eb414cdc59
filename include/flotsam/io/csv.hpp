#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace flotsam {

class OutputFile;

/// As a cell of a table: text with a comma, a quote or a line break is quoted.
/// **Source:** RFC 4180.
[[nodiscard]] std::string csv_cell(const std::string& text);

/// A table of numbers as text: a header row, then one row of values at a time.
///
/// Nine significant digits with a decimal point in every locale; names as csv_cell has them.
/// **Source:** RFC 4180. **Differs:** lines end in LF. Every row is handed to the system at once, so that a run that is
/// cut short leaves the rows it got to.
class CsvWriter {
  public:
    /// Writes the header. Throws OutputError; std::invalid_argument without columns.
    CsvWriter(const std::filesystem::path& file, std::span<const std::string> columns);
    ~CsvWriter();
    CsvWriter(CsvWriter&&) noexcept;
    CsvWriter& operator=(CsvWriter&&) noexcept;
    CsvWriter(const CsvWriter&) = delete;
    CsvWriter& operator=(const CsvWriter&) = delete;

    /// One value per column. Throws OutputError; std::invalid_argument for another number of values.
    void row(std::span<const double> values);

    /// Throws OutputError. Without it the file is closed unchecked.
    void close();

  private:
    std::unique_ptr<OutputFile> file_;
    std::size_t columns_;
    std::string line_;
};

} // namespace flotsam
