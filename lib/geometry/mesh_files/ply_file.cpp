#include "mesh_files.hpp"
#include "words.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
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

/// Reads one header line into `header`.
void read_header_line(const std::string& line, PlyHeader& header)
{
    const MeshFileFault fault("its header line " + in_quotes(line) + " is not valid");
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
            throw fault;
    } else if (keyword == "element") {
        PlyElement element;
        if (!(words >> element.name >> element.count)) throw fault;
        header.elements.push_back(element);
    } else if (keyword == "property") {
        PlyProperty property;
        words >> property.type;
        if (property.type == "list") words >> property.count_type >> property.type;
        words >> property.name;
        const bool is_known =
            type_size(property.type) > 0 && (property.count_type.empty() || type_size(property.count_type) > 0);
        if (header.elements.empty() || property.name.empty() || !is_known) throw fault;
        header.elements.back().properties.push_back(property);
    } // else comments, and lines that say nothing about the layout
}

PlyHeader read_header(std::string_view file)
{
    if (file.substr(0, 3) != "ply") throw MeshFileFault("it does not begin with \"ply\"");
    PlyHeader header;
    for (std::size_t at = 0; const auto line = take_line(file, at);) {
        if (*line == "end_header") {
            header.size = at;
            if (header.format == PlyFormat::none) throw MeshFileFault("its header names no format");
            return header;
        }
        read_header_line(*line, header);
    }
    throw MeshFileFault("it is truncated: its header does not end");
}

/// Numbers of the body one after the other; nothing at its end.
class PlyBody {
  public:
    PlyBody(std::string_view bytes, PlyFormat format) : bytes_(bytes), words_(bytes), format_(format) {}

    std::optional<double> next(std::string_view type)
    {
        return format_ == PlyFormat::ascii ? number_of(words_.next()) : next_bytes(type);
    }

    /// Whether an ASCII body has more to say; some writers pad binary ones.
    bool has_more() { return format_ == PlyFormat::ascii && !words_.next().empty(); }

  private:
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
    Words words_; ///< of an ASCII body
    PlyFormat format_;
};

/// What makes the triangles, in the byte order of `binary_little_endian`.
struct PlyContent {
    std::uint64_t vertices = 0;
    std::uint64_t faces = 0;
    std::string vertex_data; ///< x, y, z as float
    std::string face_data;   ///< number of corners and their vertices as uint
};

void append(std::string& data, std::uint32_t number)
{
    for (unsigned shift = 0; shift < 32; shift += 8) data += static_cast<char>(number >> shift & 0xffU);
}

class PlyReader {
  public:
    explicit PlyReader(std::string_view file)
        : header_(read_header(file)), body_(file.substr(header_.size), header_.format)
    {
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") check_vertex(element);
            if (element.name == "vertex") content_.vertices = element.count;
            if (element.name == "tristrips" && element.count > 0)
                throw MeshFileFault("it has strips of triangles (element tristrips), allowed are faces");
        }
    }

    PlyContent read()
    {
        for (const PlyElement& element : header_.elements) read_element(element);
        if (body_.has_more()) throw MeshFileFault("it has more numbers than its header announces");
        return std::move(content_);
    }

  private:
    void check_vertex(const PlyElement& element) const
    {
        const auto is_vertex = [](const PlyElement& other) { return other.name == "vertex"; };
        if (std::count_if(header_.elements.begin(), header_.elements.end(), is_vertex) > 1)
            throw MeshFileFault("its header has more than one element vertex");
        for (const char* axis : kAxes) {
            const auto is_axis = [axis](const PlyProperty& p) { return p.name == axis && p.count_type.empty(); };
            if (std::count_if(element.properties.begin(), element.properties.end(), is_axis) != 1)
                throw MeshFileFault("its vertices need one property " + std::string(axis));
        }
    }

    void read_element(const PlyElement& element)
    {
        // Without properties every count fits into any file.
        if (element.properties.empty() && element.count > 0)
            throw MeshFileFault("its element " + element.name + " has no properties");
        for (row_ = 0; row_ < element.count; ++row_)
            element.name == "vertex" ? read_vertex(element) : read_other(element);
    }

    void read_vertex(const PlyElement& element)
    {
        std::array<float, 3> point{};
        for (const PlyProperty& property : element.properties) {
            if (!property.count_type.empty()) {
                read_list(element, property);
                continue;
            }
            const auto value = static_cast<float>(next(element, property.type));
            for (std::size_t k = 0; k < 3; ++k)
                if (property.name == kAxes[k]) point[k] = value;
        }
        for (const float x : point) append(content_.vertex_data, std::bit_cast<std::uint32_t>(x));
    }

    void read_other(const PlyElement& element)
    {
        for (const PlyProperty& property : element.properties) {
            if (property.count_type.empty())
                (void)next(element, property.type);
            else if (element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index"))
                read_corners(element, property);
            else
                read_list(element, property);
        }
    }

    void read_corners(const PlyElement& element, const PlyProperty& list)
    {
        const double length = list_length(element, list, 3.0);
        std::string corners;
        for (double k = 0.0; k < length; k += 1.0) {
            const double vertex = next(element, list.type);
            if (!(vertex >= 0.0 && vertex < static_cast<double>(content_.vertices)) || vertex != std::floor(vertex)) {
                std::ostringstream fault;
                fault << place(element) << " names vertex " << vertex;
                if (content_.vertices > 0)
                    fault << ", allowed are 0 to " << content_.vertices - 1;
                else
                    fault << ", but it has no vertices";
                throw MeshFileFault(fault.str());
            }
            append(corners, static_cast<std::uint32_t>(vertex));
        }
        append(content_.face_data, static_cast<std::uint32_t>(length));
        content_.face_data += corners;
        ++content_.faces;
    }

    /// Of which only the length matters.
    void read_list(const PlyElement& element, const PlyProperty& list)
    {
        const double length = list_length(element, list, 0.0);
        for (double k = 0.0; k < length; k += 1.0) (void)next(element, list.type);
    }

    double list_length(const PlyElement& element, const PlyProperty& list, double least)
    {
        const double length = next(element, list.count_type);
        if (!(length >= least) || length != std::floor(length)) {
            std::ostringstream fault;
            fault << place(element) << " cannot have a list of " << length << " numbers";
            if (least > 0.0) fault << ", at least " << least << " are needed";
            throw MeshFileFault(fault.str());
        }
        return length;
    }

    double next(const PlyElement& element, std::string_view type)
    {
        const auto value = body_.next(type);
        if (!value) throw MeshFileFault("it is truncated, or not numbers, at " + place(element));
        return *value;
    }

    [[nodiscard]] std::string place(const PlyElement& element) const
    {
        return element.name + " " + std::to_string(row_) + " of " + std::to_string(element.count);
    }

    static constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
    PlyHeader header_;
    PlyBody body_;
    PlyContent content_;
    std::uint64_t row_ = 0;
};

} // namespace

std::string plain_ply(std::string_view file)
{
    const PlyContent content = PlyReader(file).read();
    if (content.faces == 0) throw MeshFileFault("it has no triangles");
    // assimp takes a first data byte 0x0A for the end of a line that ends with \r\n: with such lines there is one.
    return "ply\r\nformat binary_little_endian 1.0\r\nelement vertex " + std::to_string(content.vertices) +
           "\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nelement face " +
           std::to_string(content.faces) + "\r\nproperty list uint uint vertex_indices\r\nend_header\r\n" +
           content.vertex_data + content.face_data;
}

} // namespace flotsam
