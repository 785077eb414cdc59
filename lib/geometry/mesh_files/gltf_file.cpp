#include "mesh_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flotsam {

namespace {

using nlohmann::json;
using std::filesystem::path;

constexpr std::uint64_t kFloat = 5126;
constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();

std::uint32_t little_endian(std::string_view bytes)
{
    std::uint32_t number = 0;
    for (std::size_t k = 0; k < bytes.size(); ++k)
        number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k])) << (8 * k);
    return number;
}

std::string from_base64(std::string_view text)
{
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    if (text.size() % 4 != 0) throw MeshFileFault("it has a buffer that is not base64");
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text.substr(0, text.find('='))) {
        const std::size_t digit = kDigits.find(c);
        if (digit == std::string_view::npos) throw MeshFileFault("it has a buffer that is not base64");
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 0xffU);
    }
    return bytes;
}

/// The JSON of a GLB file and the binary chunk behind it.
struct GlbChunks {
    std::string_view text;
    std::string_view binary;
};

GlbChunks chunks_of(std::string_view file)
{
    constexpr std::size_t kHeader = 12;
    constexpr std::size_t kChunkHeader = 8;
    if (file.size() < kHeader + kChunkHeader) throw MeshFileFault("it is truncated: a GLB file has at least 20 bytes");
    const std::uint32_t announced = little_endian(file.substr(8, 4));
    if (announced > file.size())
        throw MeshFileFault("it is truncated: its header announces " + std::to_string(announced) +
                            " bytes, but it has " + std::to_string(file.size()));
    GlbChunks chunks;
    std::string_view rest = file.substr(kHeader);
    for (int k = 0; k < 2 && rest.size() >= kChunkHeader; ++k) {
        const std::uint32_t size = little_endian(rest.substr(0, 4));
        const bool is_text = rest.substr(4, 4) == "JSON";
        if (is_text != (k == 0)) throw MeshFileFault("its first chunk must be JSON, its second one BIN");
        if (size > rest.size() - kChunkHeader)
            throw MeshFileFault("it is truncated: a chunk announces " + std::to_string(size) +
                                " bytes, but there are " + std::to_string(rest.size() - kChunkHeader));
        (is_text ? chunks.text : chunks.binary) = rest.substr(kChunkHeader, size);
        rest.remove_prefix(kChunkHeader + size);
    }
    return chunks;
}

std::string bytes_of(std::uint64_t number)
{
    std::string bytes;
    for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(number >> shift & 0xffU);
    return bytes;
}

std::string glb_of(std::string text, std::string_view binary)
{
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string padded(binary);
    padded.resize((padded.size() + 3) / 4 * 4, '\0');
    const std::string chunks =
        bytes_of(text.size()) + "JSON" + text + bytes_of(padded.size()) + std::string("BIN\0", 4) + padded;
    return "glTF" + bytes_of(2) + bytes_of(12 + chunks.size()) + chunks;
}

struct GltfAccessor {
    std::uint64_t count = 0;
    std::uint64_t component = 0;       ///< its componentType
    std::string type;                  ///< "SCALAR", "VEC3", ...
    std::uint64_t stride = 0;          ///< bytes from one value to the next
    std::optional<std::string> buffer; ///< from its first value on; nothing if it is not plainly in a buffer
};

class GltfReader {
  public:
    GltfReader(std::string_view text, std::string_view binary, const path& file) : binary_(binary), file_(file)
    {
        gltf_ = json::parse(text);
        if (!gltf_.is_object()) throw MeshFileFault("it is no JSON object");
    }

    std::string plain()
    {
        check_meshes();
        check_nodes();
        strip();
        return gltf_.dump();
    }

  private:
    void check_meshes()
    {
        const json& meshes = list("meshes");
        for (std::size_t m = 0; m < meshes.size(); ++m) {
            const json& primitives = member(meshes[m], "primitives", "mesh " + std::to_string(m));
            for (std::size_t p = 0; p < primitives.size(); ++p)
                check_primitive(primitives[p], "primitive " + std::to_string(p) + " of mesh " + std::to_string(m));
        }
    }

    /// Materials, pictures, cameras and motion are nothing to us, and more for assimp to trip over.
    void strip()
    {
        for (const char* name : {"animations", "cameras", "images", "materials", "samplers", "skins", "textures"})
            gltf_.erase(name);
        for (const char* name : {"nodes", "meshes"}) gltf_.emplace(name, json::array());
        for (json& node : gltf_["nodes"])
            for (const char* name : {"camera", "extensions", "skin", "weights"}) node.erase(name);
        for (json& mesh : gltf_["meshes"]) {
            mesh.erase("weights");
            for (json& primitive : mesh["primitives"]) {
                primitive.erase("material");
                primitive.erase("targets");
                if (!primitive.contains("extensions")) // which may have the rest of the attributes compressed
                    primitive["attributes"] = {{"POSITION", primitive["attributes"]["POSITION"]}};
            }
        }
    }

    const json& list(const char* name) const
    {
        static const json kNone = json::array();
        const auto found = gltf_.find(name);
        if (found == gltf_.end()) return kNone;
        if (!found->is_array())
            throw MeshFileFault("it has " + std::string(name) + " that are no list; read is glTF 2");
        return *found;
    }

    static const json& member(const json& parent, const char* name, const std::string& place)
    {
        if (!parent.is_object() || !parent.contains(name)) throw MeshFileFault("its " + place + " has no " + name);
        return parent.at(name);
    }

    static std::uint64_t number(const json& parent, const char* name, const std::string& place,
                                std::optional<std::uint64_t> missing = {})
    {
        if (missing && parent.is_object() && !parent.contains(name)) return *missing;
        const json& value = member(parent, name, place);
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kMost)
            throw MeshFileFault("its " + place + " needs a whole number >= 0 as " + name);
        return value.get<std::uint64_t>();
    }

    const json& item(const char* name, std::uint64_t index, const std::string& place) const
    {
        const json& items = list(name);
        if (index >= items.size())
            throw MeshFileFault("its " + place + " names number " + std::to_string(index) + " of its " + name +
                                ", there are " + std::to_string(items.size()) + ", counted from 0");
        return items[index];
    }

    // ---- buffers ----

    /// Nothing if it cannot be read, which assimp says better.
    const std::optional<std::string>& buffer(std::uint64_t index, const std::string& place)
    {
        const auto known = buffers_.find(index);
        if (known != buffers_.end()) return known->second;
        return buffers_[index] = read_buffer(item("buffers", index, place), index);
    }

    std::optional<std::string> read_buffer(const json& description, std::uint64_t index) const
    {
        const std::string place = "buffer " + std::to_string(index);
        const std::uint64_t length = number(description, "byteLength", place);
        if (!description.contains("uri")) {
            if (index == 0 && binary_.size() >= length) return std::string(binary_.substr(0, length));
            throw MeshFileFault("its " + place + " has no uri");
        }
        if (!description["uri"].is_string()) throw MeshFileFault("its " + place + " has a uri that is no text");
        const std::string uri = description["uri"].get<std::string>();
        std::string bytes;
        if (uri.rfind("data:", 0) == 0) {
            const std::size_t comma = uri.find(";base64,");
            if (comma == std::string::npos) throw MeshFileFault("its " + place + " is not base64");
            bytes = from_base64(std::string_view(uri).substr(comma + 8));
        } else {
            std::ifstream stream(file_.parent_path() / uri, std::ios::binary);
            if (!stream.is_open()) return std::nullopt;
            bytes.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
        }
        if (bytes.size() < length)
            throw MeshFileFault("its " + place + " has " + std::to_string(bytes.size()) + " bytes, announced are " +
                                std::to_string(length));
        bytes.resize(length);
        return bytes;
    }

    GltfAccessor accessor(std::uint64_t index, const std::string& user)
    {
        const json& description = item("accessors", index, user);
        const std::string place = "accessor " + std::to_string(index);
        GltfAccessor result;
        result.count = number(description, "count", place);
        result.component = number(description, "componentType", place);
        const json& type = member(description, "type", place);
        result.type = type.is_string() ? type.get<std::string>() : "";
        result.stride = value_size(result, place);
        if (description.contains("sparse")) throw MeshFileFault("its " + place + " is sparse, allowed are whole ones");
        if (!description.contains("bufferView")) return result; // compressed, by an extension
        locate(description, place, result);
        return result;
    }

    static std::uint64_t value_size(const GltfAccessor& accessor, const std::string& place)
    {
        static const std::map<std::string, std::uint64_t> kNumbers{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                                   {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
        static const std::map<std::uint64_t, std::uint64_t> kBytes{{5120, 1}, {5121, 1}, {5122, 2},
                                                                   {5123, 2}, {5125, 4}, {kFloat, 4}};
        const auto numbers = kNumbers.find(accessor.type);
        const auto bytes = kBytes.find(accessor.component);
        if (numbers == kNumbers.end() || bytes == kBytes.end())
            throw MeshFileFault("its " + place + " has a type or componentType that glTF does not know");
        return numbers->second * bytes->second;
    }

    void locate(const json& description, const std::string& place, GltfAccessor& result)
    {
        const std::uint64_t view_index = number(description, "bufferView", place);
        const json& view = item("bufferViews", view_index, place);
        const std::string view_place = "bufferView " + std::to_string(view_index);
        const std::uint64_t size = result.stride;
        result.stride = number(view, "byteStride", view_place, size);
        if (result.stride < size)
            throw MeshFileFault("its " + view_place + " has a byteStride of " + std::to_string(result.stride) +
                                ", values of its " + place + " have " + std::to_string(size) + " bytes");
        const std::uint64_t offset = number(description, "byteOffset", place, 0);
        const std::uint64_t length = number(view, "byteLength", view_place);
        const std::uint64_t begin = number(view, "byteOffset", view_place, 0);
        const std::uint64_t end = result.count > 0 ? offset + result.stride * (result.count - 1) + size : offset;
        if (end > length)
            throw MeshFileFault("its " + place + " needs " + std::to_string(end) + " bytes of its " + view_place +
                                ", which has " + std::to_string(length));
        const std::uint64_t buffer_index = number(view, "buffer", view_place);
        const std::optional<std::string>& bytes = buffer(buffer_index, view_place);
        if (!bytes) return;
        if (begin + length > bytes->size())
            throw MeshFileFault("its " + view_place + " ends at byte " + std::to_string(begin + length) +
                                " of its buffer " + std::to_string(buffer_index) + ", which has " +
                                std::to_string(bytes->size()));
        result.buffer = bytes->substr(begin + offset, end - offset);
    }

    // ---- meshes ----

    void check_primitive(const json& primitive, const std::string& place)
    {
        const json& attributes = member(primitive, "attributes", place);
        if (!attributes.is_object()) throw MeshFileFault("its " + place + " has attributes that are no JSON object");
        const GltfAccessor points = accessor(number(attributes, "POSITION", place), place);
        if (points.type != "VEC3" || points.component != kFloat)
            throw MeshFileFault("its " + place + " has positions that are not VEC3 of float");
        std::uint64_t corners = points.count;
        if (primitive.contains("indices")) {
            const std::uint64_t index = number(primitive, "indices", place);
            const GltfAccessor indices = accessor(index, place);
            check_indices(indices, points.count, "accessor " + std::to_string(index));
            corners = indices.count;
        }
        check_corners(number(primitive, "mode", place, 4), corners, place);
    }

    static void check_indices(const GltfAccessor& indices, std::uint64_t points, const std::string& place)
    {
        static const std::map<std::uint64_t, std::size_t> kBytes{{5121, 1}, {5123, 2}, {5125, 4}};
        const auto bytes = kBytes.find(indices.component);
        if (indices.type != "SCALAR" || bytes == kBytes.end())
            throw MeshFileFault("its " + place + " has indices that are not whole numbers >= 0");
        if (!indices.buffer) return;
        for (std::uint64_t k = 0; k < indices.count; ++k) {
            const std::uint32_t vertex =
                little_endian(std::string_view(*indices.buffer).substr(k * indices.stride, bytes->second));
            if (vertex >= points)
                throw MeshFileFault("index " + std::to_string(k) + " in its " + place + " names vertex " +
                                    std::to_string(vertex) + ", there are " + std::to_string(points));
        }
    }

    static void check_corners(std::uint64_t mode, std::uint64_t corners, const std::string& place)
    {
        constexpr std::uint64_t kTriangles = 4;
        constexpr std::uint64_t kFan = 6;
        if (mode > kFan) throw MeshFileFault("its " + place + " has a mode above 6");
        const std::uint64_t least = mode >= kTriangles ? 3 : mode == 0 ? 1 : 2;
        if (corners < least || (mode == kTriangles && corners % 3 != 0))
            throw MeshFileFault("its " + place + " has " + std::to_string(corners) + " corners, needed are " +
                                (mode == kTriangles ? "three for each triangle" : "at least " + std::to_string(least)));
    }

    // ---- nodes ----

    void check_nodes()
    {
        const json& nodes = list("nodes");
        std::vector<int> state(nodes.size(), 0);
        for (std::size_t k = 0; k < nodes.size(); ++k) visit(k, state, 0);
    }

    /// A node may be placed once only, and not within itself.
    void visit(std::uint64_t index, std::vector<int>& state, int depth)
    {
        const std::string place = "node " + std::to_string(index);
        const json& node = item("nodes", index, "tree of nodes");
        if (state[index] == 1 || depth > 500) throw MeshFileFault("its " + place + " is placed within itself");
        if (state[index] == 2) return;
        state[index] = 1;
        if (!node.is_object()) throw MeshFileFault("its " + place + " is no JSON object");
        if (node.contains("mesh")) (void)item("meshes", number(node, "mesh", place), place);
        if (node.contains("children"))
            for (const json& child : node["children"]) {
                if (!child.is_number_unsigned())
                    throw MeshFileFault("its " + place + " has children that are no numbers");
                visit(child.get<std::uint64_t>(), state, depth + 1);
            }
        state[index] = 2;
    }

    json gltf_;
    std::string_view binary_;
    const path& file_;
    std::map<std::uint64_t, std::optional<std::string>> buffers_;
};

} // namespace

std::string plain_gltf(std::string_view file, const path& path)
{
    const bool is_binary = file.substr(0, 4) == "glTF";
    const GlbChunks chunks = is_binary ? chunks_of(file) : GlbChunks{file, {}};
    try {
        std::string text = GltfReader(chunks.text, chunks.binary, path).plain();
        return is_binary ? glb_of(std::move(text), chunks.binary) : text;
    } catch (const json::parse_error& error) {
        throw MeshFileFault("it is no valid JSON at byte " + std::to_string(error.byte));
    } catch (const json::exception& error) {
        throw MeshFileFault("it is no valid glTF: " + std::string(error.what()));
    }
}

} // namespace flotsam
