#include "cli/table.hpp"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace flotsam::cli {

std::string fixed(double value, int digits)
{
    std::ostringstream text;
    text << std::fixed << std::setprecision(digits) << value;
    const bool is_zero = text.str().find_first_not_of("-0.") == std::string::npos;
    return is_zero && text.str().front() == '-' ? text.str().substr(1) : text.str();
}

std::string with_sign(double value, int digits)
{
    const std::string text = fixed(value, digits);
    return text.front() == '-' ? text : '+' + text;
}

std::string significant(double value, int digits)
{
    std::ostringstream text;
    text << std::setprecision(digits) << value;
    return text.str();
}

void print_table(std::ostream& out, const std::vector<Row>& rows)
{
    std::vector<std::size_t> widths(rows.front().size());
    for (const Row& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
    for (const Row& row : rows) {
        out << "  " << std::left << std::setw(static_cast<int>(widths[0])) << row[0] << std::right;
        for (std::size_t k = 1; k < row.size(); ++k) out << "  " << std::setw(static_cast<int>(widths[k])) << row[k];
        out << "\n";
    }
}

} // namespace flotsam::cli
