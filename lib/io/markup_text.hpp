#pragma once

#include <string>

namespace flotsam {

/// As text or as an attribute's value of XML or HTML.
[[nodiscard]] inline std::string escaped(const std::string& text)
{
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '"')
            result += "&quot;";
        else
            result += c;
    }
    return result;
}

} // namespace flotsam
