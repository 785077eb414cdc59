#pragma once

#include <array>
#include <charconv>
#include <string>

namespace flotsam {

/// Appends nine significant digits. Not printf: its decimal point follows the locale.
inline void append_number(std::string& text, double value)
{
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 9);
    text.append(digits.data(), end.ptr);
}

} // namespace flotsam
