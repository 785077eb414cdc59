#include "mesh_file_structure.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>
#include <vector>

namespace flotsam {

namespace {

struct PlyProperty {
    std::string name;
    std::string type;
    std::string count_type; ///< of a list; empty for a single value
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

enum class PlyFormat { none, ascii, little_endian, big_endian };

struct PlyHeader {
    PlyFormat format = PlyFormat::none;
    std::vector<PlyElement> elements;
    std::size_t size = 0;
};

/// Bytes of a number type, 0 if there is no such type.
std::size_t type_size(std::string_view type)
{
    struct Type {
        std::string_view name;
        std::size_t size;
    };
    static constexpr std::array<Type, 16> kTypes{{{"char", 1},
                                                  {"uchar", 1},
                                                  {"int8", 1},
                                                  {"uint8", 1},
                                                  {"short", 2},
                                                  {"ushort", 2},
                                                  {"int16", 2},
                                                  {"uint16", 2},
                                                  {"int", 4},
                                                  {"uint", 4},
                                                  {"int32", 4},
                                                  {"uint32", 4},
                                                  {"float", 4},
                                                  {"float32", 4},
                                                  {"double", 8},
                                                  {"float64", 8}}};
    for (const Type& known : kTypes)
        if (known.name == type) return known.size;
    return 0;
}

/// Takes one line off the front; nothing left gives nothing.
std::optional<std::string> take_line(std::string_view file, std::size_t& at)
{
    if (at >= file.size()) return std::nullopt;
    const std::size_t end = file.find('\n', at);
    if (end == std::string_view::npos) return std::nullopt;
    std::string line(file.substr(at, end - at));
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
}

/// Reads one header line into `header`; gives what is wrong with it.
std::string read_header_line(const std::string& line, PlyHeader& header)
{
    const std::string fault = "its header line \"" + line + "\" is not valid";
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "format") {
        std::string format;
        words >> format;
        if (format == "ascii")
            header.format = PlyFormat::ascii;
        else if (format == "binary_little_endian")
            header.format = PlyFormat::little_endian;
        else if (format == "binary_big_endian")
            header.format = PlyFormat::big_endian;
        else
            return fault;
    } else if (keyword == "element") {
        PlyElement element;
        if (!(words >> element.name >> element.count)) return fault;
        header.elements.push_back(element);
    } else if (keyword == "property") {
        PlyProperty property;
        words >> property.type;
        if (property.type == "list") words >> property.count_type >> property.type;
        words >> property.name;
        const bool is_known =
            type_size(property.type) > 0 && (property.count_type.empty() || type_size(property.count_type) > 0);
        if (header.elements.empty() || property.name.empty() || !is_known) return fault;
        header.elements.back().properties.push_back(property);
    }
    return {}; // comments, and lines that say nothing about the layout
}

std::string read_header(std::string_view file, PlyHeader& header)
{
    if (file.substr(0, 3) != "ply") return "it does not begin with \"ply\"";
    for (std::size_t at = 0; const auto line = take_line(file, at);) {
        if (*line == "end_header") {
            header.size = at;
            return header.format == PlyFormat::none ? "its header names no format" : "";
        }
        const std::string fault = read_header_line(*line, header);
        if (!fault.empty()) return fault;
    }
    return "it is truncated: its header does not end";
}

/// Numbers of the body one after the other; nothing at its end.
class PlyBody {
  public:
    PlyBody(std::string_view bytes, PlyFormat format) : bytes_(bytes), format_(format) {}

    std::optional<double> next(std::string_view type)
    {
        return format_ == PlyFormat::ascii ? next_word() : next_bytes(type);
    }

  private:
    std::optional<double> next_word()
    {
        constexpr std::string_view kSpace = " \t\r\n";
        const std::size_t begin = std::min(bytes_.find_first_not_of(kSpace), bytes_.size());
        const std::size_t end = std::min(bytes_.find_first_of(kSpace, begin), bytes_.size());
        if (begin == end) return std::nullopt;
        const std::string word(bytes_.substr(begin, end - begin));
        bytes_.remove_prefix(end);
        char* stop = nullptr;
        const double value = std::strtod(word.c_str(), &stop);
        if (*stop != '\0') return std::nullopt;
        return value;
    }

    std::optional<double> next_bytes(std::string_view type)
    {
        const std::size_t size = type_size(type);
        if (bytes_.size() < size) return std::nullopt;
        std::array<char, 8> raw{};
        std::copy_n(bytes_.begin(), size, raw.begin());
        bytes_.remove_prefix(size);
        const bool is_foreign = (format_ == PlyFormat::big_endian) == (std::endian::native == std::endian::little);
        if (is_foreign) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
        return value_of(raw.data(), size, type);
    }

    template <class Number>
    static double as(const char* raw)
    {
        Number value;
        std::memcpy(&value, raw, sizeof(value));
        return static_cast<double>(value);
    }

    static double value_of(const char* raw, std::size_t size, std::string_view type)
    {
        if (type.front() == 'f') return as<float>(raw);
        if (type.front() == 'd') return as<double>(raw);
        const bool is_unsigned = type.front() == 'u';
        if (size == 1) return is_unsigned ? as<std::uint8_t>(raw) : as<std::int8_t>(raw);
        if (size == 2) return is_unsigned ? as<std::uint16_t>(raw) : as<std::int16_t>(raw);
        return is_unsigned ? as<std::uint32_t>(raw) : as<std::int32_t>(raw);
    }

    std::string_view bytes_;
    PlyFormat format_;
};

/// Walks over one face's corners, or over another list of which only the length matters.
std::string walk_list(PlyBody& body, const PlyProperty& list, const std::string& place, double vertices)
{
    const bool is_corners = list.name == "vertex_indices" || list.name == "vertex_index";
    const auto length = body.next(list.count_type);
    if (!length) return "it is truncated, or not numbers, at " + place;
    if (!(*length >= (is_corners ? 1.0 : 0.0)) || *length != std::floor(*length))
        return place + " cannot have a list of " + std::to_string(*length) + " numbers";
    for (double k = 0.0; k < *length; k += 1.0) {
        const auto value = body.next(list.type);
        if (!value) return "it is truncated, or not numbers, at " + place;
        if (is_corners && !(*value >= 0.0 && *value < vertices)) {
            std::ostringstream fault;
            fault << place << " names vertex " << *value << ", allowed are 0 to " << vertices - 1.0;
            return fault.str();
        }
    }
    return {};
}

std::string walk_element(PlyBody& body, const PlyElement& element, double vertices)
{
    // Without properties every count fits into any file.
    if (element.properties.empty())
        return element.count == 0 ? "" : "its element " + element.name + " has no properties";
    for (std::uint64_t row = 0; row < element.count; ++row)
        for (const PlyProperty& property : element.properties) {
            const std::string place = element.name + " " + std::to_string(row) + " of " + std::to_string(element.count);
            if (!property.count_type.empty()) {
                std::string fault = walk_list(body, property, place, vertices);
                if (!fault.empty()) return fault;
            } else if (!body.next(property.type)) {
                return "it is truncated, or not numbers, at " + place;
            }
        }
    return {};
}

bool begins_as_ascii_stl(std::string_view file)
{
    const std::size_t begin = std::min(file.find_first_not_of(" \t\r\n"), file.size());
    return file.substr(begin, 5) == "solid";
}

std::string lower_case(std::string_view text)
{
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

} // namespace

std::string fault_of_ply(std::string_view file)
{
    PlyHeader header;
    std::string fault = read_header(file, header);
    double vertices = 0.0;
    for (const PlyElement& element : header.elements)
        if (element.name == "vertex") vertices = static_cast<double>(element.count);
    PlyBody body(file.substr(header.size), header.format);
    for (std::size_t k = 0; k < header.elements.size() && fault.empty(); ++k)
        fault = walk_element(body, header.elements[k], vertices);
    return fault;
}

std::string fault_of_stl(std::string_view file)
{
    constexpr std::size_t kHeader = 84;
    constexpr std::size_t kFacet = 50;
    std::uint32_t facets = 0; // little endian, as the format says
    for (std::size_t k = 0; k < 4 && file.size() >= kHeader; ++k)
        facets |= static_cast<std::uint32_t>(static_cast<unsigned char>(file[80 + k])) << (8 * k);
    const std::uint64_t announced = kHeader + kFacet * static_cast<std::uint64_t>(facets);
    if (file.size() >= kHeader && file.size() == announced) return {};
    if (begins_as_ascii_stl(file)) {
        const std::string tail = lower_case(file.substr(file.size() - std::min<std::size_t>(file.size(), 1000)));
        return tail.find("endsolid") == std::string::npos ? "it is truncated: there is no \"endsolid\" at its end" : "";
    }
    if (file.size() < kHeader) return "it is truncated: a binary STL file has at least 84 bytes";
    return "its header announces " + std::to_string(facets) + " triangles, which is a file of " +
           std::to_string(announced) + " bytes, but it has " + std::to_string(file.size());
}

} // namespace flotsam
