#include "flotsam/io/csv.hpp"

#include "flotsam/core/contracts.hpp"
#include "io/number_text.hpp"
#include "io/output_file.hpp"

namespace flotsam {

std::string csv_cell(const std::string& text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + '"';
}

CsvWriter::CsvWriter(const std::filesystem::path& file, std::span<const std::string> columns) : columns_(columns.size())
{
    require(!columns.empty(), "a table must have at least one column");
    file_ = std::make_unique<OutputFile>(file, /*keep_if_unfinished=*/true);
    for (const std::string& name : columns) {
        if (!line_.empty()) line_ += ',';
        line_ += csv_cell(name);
    }
    file_->write(line_ + '\n');
    file_->flush();
}

CsvWriter::~CsvWriter() = default;
CsvWriter::CsvWriter(CsvWriter&&) noexcept = default;
CsvWriter& CsvWriter::operator=(CsvWriter&&) noexcept = default;

void CsvWriter::row(std::span<const double> values)
{
    require(file_ != nullptr, "a closed table takes no rows");
    require(values.size() == columns_, "a row must have one value per column", values.size());
    line_.clear();
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (k > 0) line_ += ',';
        append_number(line_, values[k]);
    }
    line_ += '\n';
    file_->write(line_);
    file_->flush();
}

void CsvWriter::close()
{
    if (file_ == nullptr) return;
    file_->close();
    file_.reset();
}

} // namespace flotsam
