#include "mesh_files.hpp"
#include "words.hpp"

#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <vector>

namespace flotsam {

namespace {

using pugi::xml_node;

constexpr std::array<std::string_view, 7> kPrimitives{"triangles", "polylist", "polygons",  "trifans",
                                                      "tristrips", "lines",    "linestrips"};
constexpr std::array<std::string_view, 4> kArrays{"float_array", "int_array", "Name_array", "IDREF_array"};
constexpr std::array<std::string_view, 6> kLibraries{
    "asset", "library_geometries", "library_nodes", "library_visual_scenes", "library_controllers", "scene"};

template <class Names>
bool is_one_of(std::string_view name, const Names& names)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

struct DaeArray {
    std::int64_t count = 0;
    bool is_float = false;
};

/// Data that <accessor> gives a <source>'s users.
struct DaeSource {
    std::int64_t count = 0;
    bool is_point = false; ///< has x, y and z
};

class DaeReader {
  public:
    explicit DaeReader(std::string_view file) : file_(file)
    {
        const auto result = document_.load_buffer(file.data(), file.size(), pugi::parse_default);
        if (!result)
            throw MeshFileFault("it is no valid XML: " + std::string(result.description()) + " " +
                                on_line(line_at(result.offset)));
        if (!document_.child("COLLADA")) throw MeshFileFault("it has no element <COLLADA>");
    }

    std::string plain()
    {
        strip();
        walk(document_, 0);
        check_node_loops();
        std::ostringstream text;
        document_.save(text, "", pugi::format_raw);
        return text.str();
    }

  private:
    /// Materials, pictures, lights and motion are nothing to us, and more for assimp to trip over.
    void strip()
    {
        xml_node root = document_.child("COLLADA");
        for (xml_node child = root.first_child(); child;) {
            const xml_node next = child.next_sibling();
            if (!is_one_of(child.name(), kLibraries)) root.remove_child(child);
            child = next;
        }
    }

    /// Sources come before the primitives that use them, in the document as here.
    void walk(xml_node parent, int depth)
    {
        if (depth > 200) refuse(parent, "lies deeper than 200 elements");
        for (xml_node node : parent.children()) {
            const std::string_view name = node.name();
            if (is_one_of(name, kArrays)) check_array(node);
            if (name == "vertices") check_vertices(node);
            if (is_one_of(name, kPrimitives)) check_primitive(node);
            check_transform(node);
            walk(node, depth + 1);
            if (name == "source") check_source(node);
        }
    }

    // ---- numbers ----

    [[nodiscard]] std::size_t line_at(std::ptrdiff_t offset) const
    {
        const std::string_view before = file_.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
        return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    }

    [[noreturn]] void refuse(xml_node node, const std::string& reason) const
    {
        refuse(node, line_at(node.offset_debug()), reason);
    }

    [[noreturn]] static void refuse(xml_node node, std::size_t line, const std::string& reason)
    {
        throw MeshFileFault("its element <" + std::string(node.name()) + "> " + on_line(line) + " " + reason);
    }

    std::int64_t attribute(xml_node node, const char* name, std::optional<std::int64_t> missing = {}) const
    {
        const pugi::xml_attribute found = node.attribute(name);
        if (!found && missing) return *missing;
        if (!found) refuse(node, "has no " + std::string(name));
        const auto value = whole_number_of(found.value());
        if (!value || *value < 0 || *value > std::numeric_limits<std::int32_t>::max())
            refuse(node,
                   "has " + std::string(name) + "=" + in_quotes(found.value()) + ", allowed is a whole number >= 0");
        return *value;
    }

    /// All its words; comments and elements among them would hide the rest from assimp.
    Words words_of(xml_node node) const
    {
        const xml_node text = node.first_child();
        if (text && (text.type() == pugi::node_element || text.next_sibling()))
            refuse(node, "has a comment or an element among its values");
        return Words(text.value(), text ? line_at(text.offset_debug()) : 1);
    }

    std::vector<std::int64_t> indices_of(xml_node node) const
    {
        std::vector<std::int64_t> indices;
        Words words = words_of(node);
        for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
            const auto value = whole_number_of(word);
            if (!value || *value < 0 || *value > std::numeric_limits<std::int32_t>::max())
                refuse(node, words.line(), "has " + in_quotes(word) + ", allowed are whole numbers >= 0");
            indices.push_back(*value);
        }
        return indices;
    }

    std::int64_t count_numbers(xml_node node) const
    {
        std::int64_t count = 0;
        Words words = words_of(node);
        for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count)
            if (!number_of(word)) refuse(node, words.line(), "has " + in_quotes(word) + ", allowed are numbers");
        return count;
    }

    void check_array(xml_node node)
    {
        const bool is_numbers =
            node.name() == std::string_view("float_array") || node.name() == std::string_view("int_array");
        const std::int64_t announced = attribute(node, "count");
        std::int64_t count = 0;
        if (is_numbers) {
            count = count_numbers(node);
        } else {
            Words words = words_of(node);
            while (!words.next().empty()) ++count;
        }
        if (count != announced)
            refuse(node, "has " + std::to_string(count) + " values, but its count is " + std::to_string(announced));
        const bool is_float = node.name() == std::string_view("float_array");
        if (!arrays_.insert({new_id(node), {count, is_float}}).second) refuse_id(node);
    }

    void check_transform(xml_node node) const
    {
        static const std::map<std::string_view, std::int64_t> kSizes{{"lookat", 9}, {"matrix", 16},   {"rotate", 4},
                                                                     {"scale", 3},  {"translate", 3}, {"skew", 7}};
        const auto size = kSizes.find(node.name());
        if (size == kSizes.end() || node.parent().name() != std::string_view("node")) return;
        const std::int64_t count = count_numbers(node);
        if (count != size->second)
            refuse(node, "has " + std::to_string(count) + " values, needed are " + std::to_string(size->second));
    }

    // ---- meshes ----

    /// Empty if there is none.
    static std::string id_of_url(const char* url) { return *url == '#' ? url + 1 : ""; }

    std::string new_id(xml_node node) const
    {
        const std::string id = node.attribute("id").value();
        if (id.empty()) refuse(node, "has no id");
        return id;
    }

    [[noreturn]] void refuse_id(xml_node node) const
    {
        refuse(node, "has the id " + in_quotes(node.attribute("id").value()) + " of another one");
    }

    void check_source(xml_node source)
    {
        const xml_node node = source.child("technique_common").child("accessor");
        if (!node) return; // of no use to a mesh
        const char* url = node.attribute("source").value();
        const auto array = arrays_.find(id_of_url(url));
        if (array == arrays_.end())
            refuse(node, "has the source " + in_quotes(url) + ", allowed is the id of an array before it");
        const std::int64_t count = attribute(node, "count");
        const std::int64_t stride = attribute(node, "stride", 1);
        const std::int64_t end = attribute(node, "offset", 0) + stride * count;
        std::int64_t params = 0;
        std::set<std::string> axes;
        for (xml_node param : node.children("param")) {
            axes.insert(param.attribute("name").value());
            ++params;
        }
        if (params > stride)
            refuse(node, "has " + std::to_string(params) + " params, but its stride is " + std::to_string(stride));
        if (end > array->second.count)
            refuse(node,
                   "takes " + std::to_string(end) + " values of an array of " + std::to_string(array->second.count));
        const bool is_point = array->second.is_float && axes.count("X") + axes.count("Y") + axes.count("Z") == 3;
        if (!sources_.insert({new_id(source), {count, is_point}}).second) refuse_id(source);
    }

    /// Keeps the positions only.
    void check_vertices(xml_node node)
    {
        std::vector<xml_node> others;
        std::vector<xml_node> positions;
        for (xml_node input : node.children())
            (input.attribute("semantic").value() == std::string_view("POSITION") ? positions : others).push_back(input);
        if (positions.size() != 1)
            refuse(node, "needs one input POSITION, but has " + std::to_string(positions.size()));
        const char* url = positions[0].attribute("source").value();
        const auto source = sources_.find(id_of_url(url));
        if (source == sources_.end() || !source->second.is_point)
            refuse(positions[0],
                   "has the source " + in_quotes(url) + ", allowed is one before it with numbers X, Y and Z");
        if (!vertices_.insert({new_id(node), source->second.count}).second) refuse_id(node);
        for (xml_node other : others) node.remove_child(other);
    }

    /// Where in each corner of a <p> the vertex is, and how many vertices there are.
    struct Corner {
        std::size_t offset = 0;
        std::size_t stride = 1;
        std::int64_t vertices = 0;
    };

    /// Keeps the vertices only.
    Corner take_inputs(xml_node primitive)
    {
        Corner corner;
        std::vector<xml_node> others;
        std::vector<xml_node> vertices;
        for (xml_node input : primitive.children("input")) {
            const auto offset = static_cast<std::size_t>(attribute(input, "offset", 0));
            const bool is_vertex = input.attribute("semantic").value() == std::string_view("VERTEX");
            corner.stride = std::max(corner.stride, offset + 1);
            if (is_vertex) corner.offset = offset;
            (is_vertex ? vertices : others).push_back(input);
        }
        if (vertices.size() != 1)
            refuse(primitive, "needs one input VERTEX, but has " + std::to_string(vertices.size()));
        const char* url = vertices[0].attribute("source").value();
        const auto found = vertices_.find(id_of_url(url));
        if (found == vertices_.end())
            refuse(vertices[0], "has the source " + in_quotes(url) + ", allowed is the id of the vertices before it");
        corner.vertices = found->second;
        vertices[0].remove_attribute("offset");
        for (xml_node other : others) primitive.remove_child(other);
        return corner;
    }

    void check_primitive(xml_node node)
    {
        const std::string_view name = node.name();
        const std::int64_t count = attribute(node, "count");
        const Corner corner = take_inputs(node);
        std::vector<std::int64_t> polygons; // corners of each in a polylist
        std::int64_t lists = 0;
        for (xml_node child : node.children()) {
            const std::string_view kind = child.name();
            if (kind == "ph") refuse(child, "is a polygon with holes, allowed are those without");
            if (kind == "input" && lists > 0) refuse(child, "comes after <p>, allowed is before");
            if (kind == "vcount") polygons = indices_of(child);
            if (kind != "p") continue;
            ++lists;
            check_list(node, child, count, corner, polygons);
        }
        const bool is_one_each = name == "polygons" || name == "trifans" || name == "tristrips";
        const std::int64_t needed = is_one_each ? count : std::min<std::int64_t>(count, 1);
        if (lists != needed && name != "lines" && name != "linestrips") // of no use to a mesh, and often wrong
            refuse(node,
                   "has " + std::to_string(lists) + " lists <p>, needed by its count are " + std::to_string(needed));
    }

    void check_list(xml_node node, xml_node list, std::int64_t count, const Corner& corner,
                    const std::vector<std::int64_t>& polygons)
    {
        const std::string_view name = node.name();
        const std::vector<std::int64_t> indices = indices_of(list);
        const std::size_t stride = corner.stride;
        std::string vertices;
        for (std::size_t k = corner.offset; k < indices.size(); k += stride) {
            if (indices[k] >= corner.vertices)
                refuse(list, "names vertex " + std::to_string(indices[k]) + " as its number " + std::to_string(k) +
                                 ", there are " + std::to_string(corner.vertices));
            vertices += std::to_string(indices[k]) + " ";
        }
        const std::size_t least = name == "lines" || name == "linestrips" ? 2 : 3;
        std::size_t corners = std::max(indices.size() / stride, least);
        if (name == "triangles") corners = 3 * static_cast<std::size_t>(count);
        if (name == "polylist") corners = corners_of_polylist(node, count, polygons, indices.size());
        if (indices.size() != corners * stride)
            refuse(list, "has " + std::to_string(indices.size()) + " indices, needed are " +
                             std::to_string(corners * stride));
        list.text().set(vertices.c_str());
    }

    std::size_t corners_of_polylist(xml_node node, std::int64_t count, const std::vector<std::int64_t>& polygons,
                                    std::size_t indices) const
    {
        if (static_cast<std::int64_t>(polygons.size()) != count)
            refuse(node, "has " + std::to_string(polygons.size()) +
                             " numbers in the <vcount> before its <p>, needed are " + std::to_string(count));
        std::size_t sum = 0;
        for (const std::int64_t n : polygons) {
            if (n < 3)
                refuse(node.child("vcount"),
                       "has a polygon of " + std::to_string(n) + " corners, at least 3 are needed");
            sum += std::min(static_cast<std::size_t>(n), indices + 1); // more than there is, without overflow
        }
        return sum;
    }

    // ---- nodes ----

    /// A node that is placed within itself has no end.
    void check_node_loops()
    {
        for (const pugi::xpath_node& found : document_.select_nodes("//node[@id]"))
            nodes_[found.node().attribute("id").value()] = found.node();
        for (const auto& [id, node] : nodes_) check_node_loop(node);
    }

    void check_node_loop(xml_node node)
    {
        if (done_.count(node.internal_object()) > 0) return;
        if (!open_.insert(node.internal_object()).second) refuse(node, "is placed within itself");
        for (xml_node child : node.children()) {
            if (child.name() == std::string_view("node")) check_node_loop(child);
            if (child.name() != std::string_view("instance_node")) continue;
            const auto target = nodes_.find(id_of_url(child.attribute("url").value()));
            if (target != nodes_.end()) check_node_loop(target->second);
        }
        open_.erase(node.internal_object());
        done_.insert(node.internal_object());
    }

    std::string_view file_;
    pugi::xml_document document_;
    std::map<std::string, DaeArray> arrays_;
    std::map<std::string, DaeSource> sources_;
    std::map<std::string, std::int64_t> vertices_; ///< how many a <vertices> has
    std::map<std::string, xml_node> nodes_;
    std::set<const void*> open_;
    std::set<const void*> done_;
};

} // namespace

std::string plain_dae(std::string_view file)
{
    return DaeReader(file).plain();
}

} // namespace flotsam
