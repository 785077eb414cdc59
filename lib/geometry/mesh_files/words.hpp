#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace flotsam {

/// The words of a text one after the other, with their lines.
class Words {
  public:
    explicit Words(std::string_view text, std::size_t line = 1) : rest_(text), line_(line) {}

    /// Empty at the end.
    std::string_view next()
    {
        std::size_t begin = 0;
        for (; begin < rest_.size() && is_space(rest_[begin]); ++begin) line_ += rest_[begin] == '\n' ? 1 : 0;
        std::size_t end = begin;
        while (end < rest_.size() && !is_space(rest_[end])) ++end;
        const std::string_view word = rest_.substr(begin, end - begin);
        rest_.remove_prefix(end);
        return word;
    }

    /// What is left of the line.
    std::string_view rest_of_line()
    {
        const std::string_view left = rest_.substr(0, rest_.find_first_of("\r\n"));
        rest_.remove_prefix(left.size());
        return left;
    }

    /// Of the word that came last.
    [[nodiscard]] std::size_t line() const { return line_; }

  private:
    static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

    std::string_view rest_;
    std::size_t line_;
};

/// The word as a number, nothing if not all of it is one. Takes nan and inf, which the mesh check names, and a decimal
/// comma, which some writers put where their language has it.
inline std::optional<double> number_of(std::string_view word)
{
    if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
    std::string text(word);
    if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    const bool is_number = error != std::errc::invalid_argument && stop == end;
    return is_number ? std::optional<double>(value) : std::nullopt;
}

/// The word as a whole number, nothing if not all of it is one.
inline std::optional<std::int64_t> whole_number_of(std::string_view word)
{
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_number = error == std::errc{} && stop == word.data() + word.size();
    return is_number ? std::optional<std::int64_t>(value) : std::nullopt;
}

/// A word of a file within a sentence; it may be long, or no text at all.
inline std::string in_quotes(std::string_view word)
{
    std::string text = "\"";
    for (const char c : word.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
    return text + (word.size() > 40 ? "...\"" : "\"");
}

inline std::string on_line(std::size_t line)
{
    return "on line " + std::to_string(line);
}

} // namespace flotsam
