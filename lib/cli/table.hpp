#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace flotsam::cli {

using Row = std::vector<std::string>;

/// With `digits` after the point; what rounds to zero has no sign.
[[nodiscard]] std::string fixed(double value, int digits);

[[nodiscard]] std::string with_sign(double value, int digits);

/// With `digits` significant digits.
[[nodiscard]] std::string significant(double value, int digits);

/// The first column to the left, numbers to the right.
void print_table(std::ostream& out, const std::vector<Row>& rows);

} // namespace flotsam::cli
