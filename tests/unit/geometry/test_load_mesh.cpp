#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/load_mesh.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "support/catch.hpp"

#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <random>

using namespace flotsam;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using std::filesystem::path;

namespace {

/// A folder that goes with the test.
class Folder {
  public:
    Folder()
        : path_(std::filesystem::temp_directory_path() /
                ("flotsam_load_mesh_" + std::to_string(std::random_device{}())))
    {
        std::filesystem::create_directories(path_);
    }
    ~Folder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    [[nodiscard]] path write(const std::string& name, const std::string& content) const
    {
        std::ofstream(path_ / name, std::ios::binary) << content;
        return path_ / name;
    }
    [[nodiscard]] const path& where() const { return path_; }

  private:
    path path_;
};

// The tetrahedron with corners at the origin, (1,0,0), (0,2,0), (0,0,3), in every format; volume 1.
const std::vector<std::array<float, 3>> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
const std::vector<std::array<int, 3>> kFaces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

template <class Number>
std::string bytes(Number number)
{
    std::string raw(sizeof(number), '\0');
    std::memcpy(raw.data(), &number, sizeof(number));
    return raw;
}

std::string words(const std::array<float, 3>& p)
{
    return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
}

std::string obj()
{
    std::string text = "# tetrahedron\no tet\n";
    for (const auto& p : kCorners) text += "v " + words(p) + "\n";
    for (const auto& f : kFaces)
        text +=
            "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " + std::to_string(f[2] + 1) + "\n";
    return text;
}

std::string stl_ascii()
{
    std::string text = "solid tet\n";
    for (const auto& f : kFaces) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int v : f) text += "vertex " + words(kCorners[v]) + "\n";
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid tet\n";
}

std::string stl_binary(const std::string& title = "made by a test")
{
    std::string data = title + std::string(80 - title.size(), ' ') + bytes(std::uint32_t{4});
    for (const auto& f : kFaces) {
        data += std::string(12, '\0');
        for (const int v : f)
            for (const float x : kCorners[v]) data += bytes(x);
        data += std::string(2, '\0');
    }
    return data;
}

std::string ply_header(const std::string& format)
{
    return "ply\nformat " + format +
           " 1.0\ncomment made by a test\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string ply_ascii(int last_index = 3)
{
    std::string text = ply_header("ascii");
    for (const auto& p : kCorners) text += words(p) + "\n";
    for (const auto& f : kFaces) {
        const int last = &f == &kFaces.back() ? last_index : f[2];
        text += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(last) + "\n";
    }
    return text;
}

template <class Number>
std::string bytes_big(Number number)
{
    std::string raw = bytes(number);
    return {raw.rbegin(), raw.rend()};
}

std::string ply_binary(bool is_big)
{
    std::string data = ply_header(is_big ? "binary_big_endian" : "binary_little_endian");
    for (const auto& p : kCorners)
        for (const float x : p) data += is_big ? bytes_big(x) : bytes(x);
    for (const auto& f : kFaces) {
        data += '\3';
        for (const int v : f) data += is_big ? bytes_big(v) : bytes(v);
    }
    return data;
}

std::string dae(const std::string& asset)
{
    std::string points;
    for (const auto& p : kCorners) points += words(p) + " ";
    return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
           asset + R"(</asset><library_geometries><geometry id="g" name="tet"><mesh>
<source id="p"><float_array id="a" count="12">)" +
           points + R"(</float_array><technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node id="n"><translate>10 20 30</translate><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::string gltf_buffer()
{
    std::string data;
    for (const auto& p : kCorners)
        for (const float x : p) data += bytes(x);
    for (const auto& f : kFaces)
        for (const int v : f) data += bytes(static_cast<std::uint16_t>(v));
    return data;
}

std::string gltf(const std::string& uri)
{
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"children":[1],"translation":[10,20,30]},{"mesh":0,"scale":[2,2,2]}],
"meshes":[{"name":"tet","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,2,3]},
{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"buffers":[{"byteLength":72)" +
           (uri.empty() ? "" : R"(,"uri":")" + uri + '"') + "}]}";
}

std::string glb()
{
    std::string json = gltf("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::string data = gltf_buffer();
    const auto size = [](const std::string& text) { return bytes(static_cast<std::uint32_t>(text.size())); };
    return "glTF" + bytes(std::uint32_t{2}) + bytes(static_cast<std::uint32_t>(28 + json.size() + data.size())) +
           size(json) + "JSON" + json + size(data) + std::string("BIN\0", 4) + data;
}

void check_is_tetrahedron(TriangleMesh mesh, const Vec3d& at = Vec3d::Zero(), double scale = 1.0)
{
    CHECK(mesh.triangles.size() == 4);
    CHECK((bounds(mesh).min - at).norm() < 1e-6);
    CHECK((bounds(mesh).max - at - scale * Vec3d(1, 2, 3)).norm() < 1e-6 * scale);
    const MeshCheckReport report = check_mesh(mesh);
    CHECK(report.closed);
    CHECK(report.notes.empty());
    CHECK(mass_properties(mesh).volume == Approx(scale * scale * scale).epsilon(1e-6));
}

std::string refusal(const path& file)
{
    try {
        (void)load_mesh(file);
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), Contains(file.string()));
        return error.what();
    }
    return "(accepted)";
}

} // namespace

TEST_CASE("each format is read with the numbers it has", "[geometry][load_mesh]")
{
    const Folder folder;
    check_is_tetrahedron(load_mesh(folder.write("tet.obj", obj())));
    check_is_tetrahedron(load_mesh(folder.write("ascii.stl", stl_ascii())));
    check_is_tetrahedron(load_mesh(folder.write("binary.STL", stl_binary())));
    check_is_tetrahedron(load_mesh(folder.write("like_ascii.stl", stl_binary("solid but binary"))));
    check_is_tetrahedron(load_mesh(folder.write("ascii.ply", ply_ascii())));
    check_is_tetrahedron(load_mesh(folder.write("little.ply", ply_binary(false))));
    check_is_tetrahedron(load_mesh(folder.write("big.ply", ply_binary(true))));
}

TEST_CASE("COLLADA keeps its units and axes, and its node transforms apply", "[geometry][load_mesh]")
{
    const std::string asset =
        GENERATE("", "<up_axis>Z_UP</up_axis>", "<unit name=\"centimeter\" meter=\"0.01\"/><up_axis>Y_UP</up_axis>",
                 "<unit name=\"inch\" meter=\"0.0254\"/><up_axis>X_UP</up_axis>");
    const Folder folder;
    check_is_tetrahedron(load_mesh(folder.write("tet.dae", dae(asset))), {10, 20, 30});
}

TEST_CASE("the nodes of glTF place its meshes", "[geometry][load_mesh]")
{
    const Folder folder;
    (void)folder.write("tet.bin", gltf_buffer());
    check_is_tetrahedron(load_mesh(folder.write("tet.gltf", gltf("tet.bin"))), {10, 20, 30}, 2.0);
    check_is_tetrahedron(load_mesh(folder.write("tet.glb", glb())), {10, 20, 30}, 2.0);
}

TEST_CASE("several parts stay several, polygons become triangles, points and lines go", "[geometry][load_mesh]")
{
    const Folder folder;
    const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    const path file =
        folder.write("two.obj", "o hull\n" + square + "f 1 2 3 4\nl 1 2\np 3\no keel\n" + square + "f 5 6 7\n");
    const TriangleMesh mesh = load_mesh(file);
    CHECK(mesh.part_names == std::vector<std::string>{"hull", "keel"});
    CHECK(mesh.part_of_triangle == std::vector<int>{0, 0, 1});
    double area = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        area += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).z();
    CHECK(area == Approx(1.5));
}

TEST_CASE("scale and up axis are applied as told, right-handed", "[geometry][load_mesh]")
{
    const Folder folder;
    const path file = folder.write("tet.obj", obj());
    using Up = MeshFileOptions::UpAxis;
    const TriangleMesh y_up = load_mesh(file, {.scale = 0.5, .up = Up::y});
    CHECK(bounds(y_up).min == Vec3d(0, -1.5, 0));
    CHECK(bounds(y_up).max == Vec3d(0.5, 0, 1));
    CHECK(mass_properties(y_up).volume == Approx(0.125));
    const TriangleMesh x_up = load_mesh(file, {.up = Up::x});
    CHECK(bounds(x_up).max == Vec3d(2, 3, 1));
    CHECK(mass_properties(x_up).volume == Approx(1.0));
    CHECK_THROWS_AS(load_mesh(file, {.scale = 0.0}), std::invalid_argument);
    CHECK_THROWS_AS(load_mesh(file, {.scale = -1.0}), std::invalid_argument);
    CHECK_THROWS_AS(load_mesh(file, {.scale = std::nan("")}), std::invalid_argument);
}

TEST_CASE("files that are no mesh files are refused", "[geometry][load_mesh]")
{
    const Folder folder;
    CHECK_THAT(refusal(folder.where() / "nowhere.obj"), EndsWith("nowhere.obj\": there is no such file"));
    CHECK_THAT(refusal(folder.where()), EndsWith("it is not a file"));
    CHECK_THAT(refusal(folder.write("notes.txt", "hello")),
               EndsWith("its name must end in .obj, .stl, .ply, .dae, .gltf or .glb"));
    for (const char* name : {"e.obj", "e.stl", "e.ply", "e.dae", "e.gltf", "e.glb"})
        CHECK_THAT(refusal(folder.write(name, "")), EndsWith("it is empty"));
    for (const char* name : {"g.obj", "g.stl", "g.ply", "g.dae", "g.gltf", "g.glb"}) {
        const std::string sentence = refusal(folder.write(name, "this is no mesh at all, only\nsome words\n"));
        CHECK(sentence != "(accepted)");
        CHECK(sentence.find('\n') == std::string::npos);
    }
}

TEST_CASE("meshes without triangles are refused", "[geometry][load_mesh]")
{
    const Folder folder;
    CHECK_THAT(refusal(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), EndsWith("it has no triangles"));
    CHECK_THAT(refusal(folder.write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n")),
               EndsWith("it has no triangles"));
    std::string bare = dae("");
    bare.erase(bare.find("<instance_geometry"), std::strlen("<instance_geometry url=\"#g\"/>"));
    CHECK_THAT(refusal(folder.write("bare.dae", bare)), EndsWith("it has no triangles"));
}

TEST_CASE("truncated files are refused, wherever they end", "[geometry][load_mesh]")
{
    const Folder folder;
    struct Whole {
        const char* name;
        std::string content;
        std::size_t tail; ///< last bytes that say nothing: without them the file is as good as whole
    };
    const std::vector<Whole> files{{"cut.stl", stl_binary(), 0},     {"ascii.stl", stl_ascii(), 6},
                                   {"ascii.ply", ply_ascii(), 2},    {"little.ply", ply_binary(false), 0},
                                   {"big.ply", ply_binary(true), 0}, {"cut.dae", dae(""), 0},
                                   {"cut.gltf", gltf("x.bin"), 0},   {"cut.glb", glb(), 0}};
    for (const Whole& whole : files)
        for (std::size_t k = 1; k <= 24; ++k) {
            const std::size_t size = (whole.content.size() - whole.tail) * k / 24 - 1;
            INFO(whole.name << " after " << size << " bytes of " << whole.content.size());
            CHECK(refusal(folder.write(whole.name, whole.content.substr(0, size))) != "(accepted)");
        }
    CHECK_THAT(refusal(folder.write("cut.stl", stl_binary().substr(0, 200))),
               EndsWith("its header announces 4 triangles, which is a file of 284 bytes, but it has 200"));
    CHECK_THAT(
        refusal(folder.write("cut.ply", ply_binary(false).substr(0, ply_header("binary_little_endian").size() + 60))),
        EndsWith("it is truncated, or not numbers, at face 0 of 4"));
    CHECK_THAT(refusal(folder.write("cut.obj", obj().substr(0, obj().size() - 5))),
               EndsWith("its face on line 10 has 1 corners, at least 3 are needed"));
}

TEST_CASE("indices of vertices that are not there are refused", "[geometry][load_mesh]")
{
    const Folder folder;
    CHECK_THAT(refusal(folder.write("tet.obj", obj() + "f 1 2 99\n")),
               EndsWith("its face on line 11 names vertex 99, allowed are 1 to 4"));
    CHECK_THAT(refusal(folder.write("back.obj", "v 0 0 0\nv 1 0 0\n\nf -1 -2 -3\nv 0 1 0\n")),
               EndsWith("its face on line 4 names vertex -3, allowed are 1 to 3"));
    CHECK_THAT(refusal(folder.write("normal.obj", obj() + "f 1//1 2//1 3//1\n")),
               EndsWith("its face on line 11 names normal 1, allowed are none, for it has none"));
    CHECK_THAT(refusal(folder.write("tet.ply", ply_ascii(77))),
               EndsWith("face 3 of 4 names vertex 77, allowed are 0 to 3"));
    CHECK_THAT(refusal(folder.write("neg.ply", ply_ascii(-1))),
               EndsWith("face 3 of 4 names vertex -1, allowed are 0 to 3"));
}

TEST_CASE("PLY headers that cannot be followed are refused", "[geometry][load_mesh]")
{
    const Folder folder;
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = ply_ascii();
        text.replace(text.find(from), from.size(), to);
        return refusal(folder.write("tet.ply", text));
    };
    CHECK_THAT(with("format ascii", "format morse"), EndsWith("its header line \"format morse 1.0\" is not valid"));
    CHECK_THAT(with("property float y", "property real y"),
               EndsWith("its header line \"property real y\" is not valid"));
    CHECK_THAT(with("element vertex 4", "element vertex"), EndsWith("its header line \"element vertex\" is not valid"));
    CHECK_THAT(with("element vertex 4", "element vertex 99999999999"), Contains("it is truncated, or not numbers"));
    CHECK_THAT(with("format ascii 1.0\n", ""), EndsWith("its header names no format"));
    CHECK_THAT(with("3 0 2 1", "0 0 2 1"), Contains("face 0 of 4 cannot have a list of 0"));
}

TEST_CASE("binary PLY is read whatever its first byte of data is", "[geometry][load_mesh]")
{
    const Folder folder;
    const int byte = GENERATE(0x00, 0x09, 0x0a, 0x0c, 0x0d, 0x20, 0x23);
    const bool has_returns = GENERATE(false, true);
    std::string file = ply_binary(false);
    const std::size_t first = ply_header("binary_little_endian").size();
    file[first] = static_cast<char>(byte); // of a float that stays next to nothing
    if (has_returns)
        for (std::size_t at = 0; at < first; ++at)
            if (file[at] == '\n' && file[at - 1] != '\r') file.insert(at, "\r");
    INFO("first byte " << byte << (has_returns ? " after \\r\\n" : " after \\n"));
    check_is_tetrahedron(load_mesh(folder.write("tet.ply", file)));
}

TEST_CASE("ASCII PLY may break its lines anywhere", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string text = ply_ascii();
    const std::size_t first = text.find("1.000000 ");
    text[text.find(' ', first)] = '\n';
    check_is_tetrahedron(load_mesh(folder.write("tet.ply", text)));
    CHECK_THAT(refusal(folder.write("more.ply", ply_ascii() + "7\n")),
               EndsWith("it has more numbers than its header announces"));
}

TEST_CASE("keywords of ASCII STL may be in upper case", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string text = stl_ascii();
    for (char& c : text) c = static_cast<char>(std::toupper(c));
    check_is_tetrahedron(load_mesh(folder.write("tet.stl", text)));
}

TEST_CASE("ASCII STL with a facet of other than three vertices is refused", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string text = stl_ascii();
    text.insert(text.find("endloop"), "vertex 1 1 1\n");
    CHECK_THAT(refusal(folder.write("four.stl", text)), EndsWith("it has \"vertex\" on line 7, allowed is endloop"));
    text = stl_ascii();
    text.replace(text.find("facet", 20), 5, "facat");
    CHECK(refusal(folder.write("typo.stl", text)) != "(accepted)");
}

TEST_CASE("OBJ is read as its format says", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string text = obj();
    text.replace(text.find("v 0.0"), 3, "  v "); // indented, and a number without its zero
    text.replace(text.find("v 1.0"), 5, "v 1,0");
    text.replace(text.find("f 1 3 2"), 7, "f -4 \\\n -2 -3 # around");
    check_is_tetrahedron(load_mesh(folder.write("tet.obj", text)));
    CHECK_THAT(refusal(folder.write("comma.obj", "v 0,5,1 0 0\n" + obj())),
               EndsWith("its vertex on line 1 has \"0,5,1\", which is no number"));
    CHECK_THAT(refusal(folder.write("flat.obj", "v 0 0\n" + obj())),
               EndsWith("its vertex on line 1 has 2 numbers, allowed are x, y and z"));
    CHECK_THAT(refusal(folder.write("word.obj", obj() + "f 1 2 x\n")),
               EndsWith("its face on line 11 has the corner \"x\", which is not made of whole numbers"));
}

TEST_CASE("COLLADA whose numbers are not counted right, or no numbers, is refused", "[geometry][load_mesh]")
{
    const Folder folder;
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = dae("");
        text.replace(text.find(from), from.size(), to);
        return refusal(folder.write("tet.dae", text));
    };
    CHECK_THAT(with(R"(id="a" count="12")", R"(id="a")"), EndsWith("its element <float_array> on line 3 has no count"));
    CHECK_THAT(with(R"(id="a" count="12")", R"(id="a" count="11")"),
               EndsWith("its element <float_array> on line 3 has 12 values, but its count is 11"));
    CHECK_THAT(with("0 2 1 0", "0 2,1 0"),
               EndsWith("its element <p> on line 6 has \"2,1\", allowed are whole numbers >= 0"));
    CHECK_THAT(with("0 2 1 0", "0 2 1.0 0"), EndsWith("has \"1.0\", allowed are whole numbers >= 0"));
    CHECK_THAT(with("0 2 1 0", "0 2 -1 0"), EndsWith("has \"-1\", allowed are whole numbers >= 0"));
    CHECK_THAT(with("0 2 1 0", "0 2 1 4"),
               EndsWith("its element <p> on line 6 names vertex 4 as its number 3, there are 4"));
    CHECK_THAT(with("0 2 1 0", "0 2 1"), EndsWith("its element <p> on line 6 has 11 indices, needed are 12"));
    CHECK_THAT(with("1.000000 0", "1.000000x 0"),
               EndsWith("its element <float_array> on line 3 has \"1.000000x\", allowed are numbers"));
    CHECK_THAT(with("stride=\"3\"", "stride=\"4\""),
               EndsWith("its element <accessor> on line 3 takes 16 values of an array of 12"));
    CHECK_THAT(with("name=\"Z\"", "name=\"S\""), Contains("allowed is one before it with numbers X, Y and Z"));
    CHECK_THAT(with("semantic=\"VERTEX\"", "semantic=\"NORMAL\""), EndsWith("needs one input VERTEX, but has 0"));
    CHECK_THAT(with("</translate>", " 40</translate>"), EndsWith("has 4 values, needed are 3"));
    CHECK_THAT(with("<instance_geometry", "<instance_node url=\"#n\"/><instance_geometry"),
               EndsWith("its element <node> on line 8 is placed within itself"));
    CHECK_THAT(with("</COLLADA>", ""), Contains("it is no valid XML: Start-end tags mismatch on line "));
}

TEST_CASE("COLLADA is read with polygons, and with normals among its indices", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string text = dae("");
    const std::size_t begin = text.find("<triangles");
    const std::size_t end = text.find("</mesh>");
    const std::string inputs = R"(<input semantic="NORMAL" source="#p" offset="0"/>)"
                               R"(<input semantic="VERTEX" source="#v" offset="1"/>)";
    const std::string polygons = GENERATE(
        R"(<polylist count="4">INPUTS<vcount>3 3 3 3</vcount><p>3 0 3 2 3 1 3 0 3 1 3 3 3 0 3 3 3 2 3 1 3 2 3 3</p></polylist>)",
        R"(<polygons count="4">INPUTS<p>3 0 3 2 3 1</p><p>3 0 3 1 3 3</p><p>3 0 3 3 3 2</p><p>3 1 3 2 3 3</p></polygons>)",
        R"(<tristrips count="1">INPUTS<p>3 0 3 2 3 1 3 3 3 0 3 2</p></tristrips>)");
    text.replace(begin, end - begin, polygons);
    text.replace(text.find("INPUTS"), 6, inputs);
    check_is_tetrahedron(load_mesh(folder.write("tet.dae", text)), {10, 20, 30});
}

TEST_CASE("glTF with indices and places that are not there is refused", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string buffer = gltf_buffer();
    buffer[48 + 2 * 5] = 9;
    (void)folder.write("tet.bin", buffer);
    CHECK_THAT(refusal(folder.write("tet.gltf", gltf("tet.bin"))),
               EndsWith("index 5 in its accessor 1 names vertex 9, there are 4"));
    std::string binary = glb();
    binary[binary.size() - 24 + 2 * 5] = 9;
    CHECK_THAT(refusal(folder.write("tet.glb", binary)),
               EndsWith("index 5 in its accessor 1 names vertex 9, there are 4"));
    (void)folder.write("tet.bin", gltf_buffer());
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = gltf("tet.bin");
        text.replace(text.find(from), from.size(), to);
        return refusal(folder.write("tet.gltf", text));
    };
    CHECK_THAT(with(R"("count":12)", R"("count":11)"),
               EndsWith("its primitive 0 of mesh 0 has 11 corners, needed are three for each triangle"));
    CHECK_THAT(with(R"("count":12)", R"("count":15)"),
               EndsWith("its accessor 1 needs 30 bytes of its bufferView 1, which has 24"));
    CHECK_THAT(with(R"("componentType":5126)", R"("componentType":5122)"),
               EndsWith("its primitive 0 of mesh 0 has positions that are not VEC3 of float"));
    CHECK_THAT(with(R"("byteOffset":48)", R"("byteOffset":49)"),
               EndsWith("its bufferView 1 ends at byte 73 of its buffer 0, which has 72"));
    CHECK_THAT(with(R"("indices":1)", R"("indices":2)"),
               EndsWith("its primitive 0 of mesh 0 names number 2 of its accessors, there are 2, counted from 0"));
    CHECK_THAT(with(R"("children":[1])", R"("children":[0])"), EndsWith("its node 0 is placed within itself"));
}

TEST_CASE("a mesh so far from its origin that float is too coarse is refused", "[geometry][load_mesh]")
{
    const Folder folder;
    const auto at = [](int x) {
        std::string text = obj();
        for (std::size_t p = 0; (p = text.find("v ", p)) != std::string::npos; p += 2)
            text.insert(p + 2, std::to_string(x)); // before 0.0 or 1.0
        return text;
    };
    CHECK_THAT(refusal(folder.write("far.obj", at(10000))),
               Contains("it is 3.74166 across but has coordinates up to 100001, which are rounded by 0.00600006; "
                        "allowed is 0.0001 of its size: move it to the origin"));
    // 6e-7 of 3.7 m is far less than anything that is simulated.
    CHECK(bounds(load_mesh(folder.write("near.obj", at(1)))).max.x() == Approx(11.0));
    (void)folder.write("tet.bin", gltf_buffer()); // a node's place is added in double, and costs nothing
    std::string placed = gltf("tet.bin");
    placed.replace(placed.find("[10,20,30]"), 10, "[100000,20,30]");
    check_is_tetrahedron(load_mesh(folder.write("tet.gltf", placed)), {100000, 20, 30}, 2.0);
}

TEST_CASE("glTF with its buffer missing or too short is refused", "[geometry][load_mesh]")
{
    const Folder folder;
    CHECK_THAT(refusal(folder.write("tet.gltf", gltf("missing.bin"))), Contains("missing.bin"));
    (void)folder.write("short.bin", gltf_buffer().substr(0, 20));
    CHECK(refusal(folder.write("short.gltf", gltf("short.bin"))) != "(accepted)");
}

TEST_CASE("a mesh with NaN is read, and the check names the vertex", "[geometry][load_mesh]")
{
    const Folder folder;
    std::string text = obj();
    text.replace(text.find("v 1.000000"), 10, "v nan");
    TriangleMesh mesh = load_mesh(folder.write("nan.obj", text));
    CHECK_THROWS_WITH(check_mesh(mesh, {.name = "nan.obj"}),
                      Contains("nan.obj has vertex ") && Contains("at (nan, 0, 0)"));
}
