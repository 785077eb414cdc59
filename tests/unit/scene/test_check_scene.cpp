#include "flotsam/scene/check_scene.hpp"
#include "scene_texts.hpp"
#include "support/catch.hpp"
#include "support_directory.hpp"

#include <filesystem>
#include <fstream>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

SceneCheck checked(const std::string& text, const std::vector<std::string>& overrides = {},
                   const std::filesystem::path& file = "dir/test.json")
{
    return check_scene(parse_scene(text, file, overrides));
}

void check_refused(const std::string& text, const std::vector<std::string>& overrides,
                   const std::vector<std::string>& parts, const std::filesystem::path& file = "dir/test.json")
{
    const std::string sentence = refusal([&] { (void)checked(text, overrides, file); });
    INFO("sentence: " << sentence);
    for (const std::string& part : parts) CHECK(sentence.find(part) != std::string::npos);
    CHECK_FALSE(sentence.empty());
}

bool has_note(const SceneCheck& check, const std::string& part)
{
    for (const std::string& note : check.notes)
        if (note.find(part) != std::string::npos) return true;
    return false;
}

/// A unit tetrahedron as OBJ; without its last face it is open.
std::string tetrahedron(const std::string& last_face = "f 2 3 4\n")
{
    return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n" + last_face;
}

} // namespace

TEST_CASE("a good scene passes with its sizes and masses", "[scene]")
{
    const SceneCheck check = checked(kCrate, {"bodies.crate.position=[0.5, 0.5, 0.6]"});
    CHECK(check.notes.empty());
    CHECK(check.fluid_particles == Approx(0.4 / (0.05 * 0.05 * 0.05)).epsilon(0.01));
    REQUIRE(check.bodies.size() == 1);
    CHECK(check.bodies[0].volume == Approx(0.008));
    CHECK(check.bodies[0].mass == Approx(4.0));
    CHECK(check.bodies[0].density_ratio == Approx(0.5));
}

TEST_CASE("mass sets the density, and fluid that overlaps bodies is said", "[scene]")
{
    std::string text = kCrate;
    text.replace(text.find("\"density\": 500"), 14, "\"mass\": 2.0");
    const SceneCheck check = checked(text);
    CHECK(check.bodies.at(0).density_ratio == Approx(0.25));
    CHECK(has_note(check, "overlaps bodies[0] (\"crate\")"));
    CHECK(check.fluid_particles < 0.4 / (0.05 * 0.05 * 0.05) - 20.0);
}

TEST_CASE("bodies outside the tank or in each other are refused", "[scene]")
{
    check_refused(kCrate, {"bodies.0.position=[1.5,0.5,0.4]"}, {"\"crate\"", "outside the tank", "+x", "walls[0]"});
    check_refused(kCrate, {"bodies.0.position=[0.5,0.5,-3]"}, {"\"crate\"", "outside the tank", "-z"});
    check_refused(kCrate, {"bodies.0.position=[0.95,0.5,0.4]"}, {"\"crate\"", "overlaps walls[0]", "50 mm", "+x"});
    CHECK(refusal([] { (void)checked(kCrate, {"bodies.0.position=[0.9,0.5,0.4]"}); }).empty()); // touches
    CHECK(refusal([] { (void)checked(kCrate, {"bodies.0.position=[0.5,0.5,2]"}); }).empty());   // the top is open

    const std::string two = "bodies=[{\"name\":\"a\",\"shape\":{\"sphere\":0.1},\"mass\":1,\"position\":[0.3,0.5,0.5]},"
                            "{\"name\":\"b\",\"shape\":{\"box\":[0.2,0.2,0.2]},\"mass\":1,\"position\":[X,0.5,0.5]}]";
    const auto at = [&](const std::string& x) { return std::string(two).replace(two.find('X'), 1, x); };
    check_refused(kCrate, {at("0.45")}, {"bodies[0] (\"a\") overlaps bodies[1] (\"b\")"});
    check_refused(kCrate, {at("0.3")}, {"bodies[0] (\"a\") overlaps bodies[1] (\"b\")"}); // one inside the other
    CHECK(refusal([&] { (void)checked(kCrate, {at("0.5")}); }).empty());

    // Face on face no point of a surface is in the other body.
    const std::string same =
        "bodies=[{\"name\":\"a\",\"shape\":{\"box\":[0.2,0.2,0.2]},\"mass\":1,\"position\":[0.5,0.5,0.5]},"
        "{\"name\":\"b\",\"shape\":{\"box\":[0.2,0.2,0.2]},\"mass\":1,\"position\":[X,0.5,0.5]}]";
    for (const char* x : {"0.5", "0.505"})
        check_refused(kCrate, {std::string(same).replace(same.find('X'), 1, x)},
                      {"bodies[0] (\"a\") overlaps bodies[1] (\"b\")"});
    CHECK(refusal([&] { (void)checked(kCrate, {std::string(same).replace(same.find('X'), 1, "0.7")}); }).empty());
}

TEST_CASE("2-D bodies are checked in their plane", "[scene]")
{
    CHECK(refusal([] { (void)checked(kRaft); }).empty());
    check_refused(kRaft, {"bodies.raft.position=[0.1,0.3]"}, {"bodies[0] (\"raft\") overlaps walls[0]", "-x"});
    const std::string two = "bodies=[{\"name\":\"a\",\"shape\":{\"disc\":0.1},\"mass\":1,\"position\":[0.3,0.5]},"
                            "{\"name\":\"b\",\"shape\":{\"box\":[0.2,0.2]},\"mass\":1,\"position\":[0.4,0.5]}]";
    check_refused(kRaft, {two}, {"bodies[0] (\"a\") overlaps bodies[1] (\"b\")"});
    CHECK(checked(kRaft).bodies.at(0).volume == Approx(0.03));
}

TEST_CASE("fluid outside the walls is cut, and some must be left", "[scene]")
{
    const SceneCheck check = checked(kCrate, {"fluids.0.blocks.0.max=[2,1,0.4]"});
    CHECK(has_note(check, "50 % outside were cut away"));
    CHECK(check.fluid_particles < 0.41 / (0.05 * 0.05 * 0.05));
    check_refused(kCrate, {"fluids.0.blocks.0={\"min\":[2,2,0],\"max\":[3,3,1]}"}, {"no fluid is left"});
    check_refused(kCrate, {"bodies.0.shape.box=[1,1,1]", "bodies.0.position=[0.5,0.5,0.5]"}, {"no fluid is left"});
}

TEST_CASE("a spacing that memory cannot hold is refused with one that fits", "[scene]")
{
    check_refused(kCrate, {"particle_spacing=1e-6"}, {"particle_spacing 1e-06", "particles", "GB", "or more fits"});
    check_refused(kRaft, {"particle_spacing=1e-9"}, {"particle_spacing 1e-09", "or more fits"});
    check_refused(kCrate, {"particle_spacing=1e-300"}, {"about inf particles", "or more fits"});
    check_refused(kCrate, {"particle_spacing=1e-3"}, {"or is a block of fluid, 1 x 1 x 0.4 m, too large?"});
    // A wall that no water comes near takes none.
    CHECK(checked(kCrate, {"walls.0.box.max=[1000,1000,1]"}).memory_bytes ==
          Approx(checked(kCrate, {"walls.0.box.max=[100,100,1]"}).memory_bytes));
}

TEST_CASE("a body too small for the particles is refused", "[scene]")
{
    check_refused(kCrate, {"bodies.0.shape.box=[0.05,0.05,0.05]"}, {"\"crate\"", "2 particle spacings"});
    check_refused(kCrate, {"bodies.0.shape.box=[0.2,0.2,1e-6]"}, {"\"crate\"", "1e-06 m thin", "5e-05 m"});
    check_refused(kRaft, {"bodies.0.shape.box=[1e-6,0.1]"}, {"\"raft\"", "1e-06 m thin"});
    CHECK(checked(kCrate, {"bodies.0.shape.box=[0.2,0.2,0.001]"}).bodies.size() == 1);
}

TEST_CASE("a body too light, too heavy or with hardly an inertia is refused", "[scene]")
{
    check_refused(kCrate, {"bodies.0.density=1e-4"}, {"\"crate\"", "1e-07 times the density of the fluid"});
    check_refused(kCrate, {"bodies.0.density=1e9", "fluids.0.density=0.1"}, {"1e+10 times the density"});
    check_refused(kCrate, {"bodies.0.inertia=[1e-9,1e-9,1e-9]"}, {"\"crate\"", "an inertia of 1e-09 kg m^2"});
    CHECK(checked(kCrate, {"bodies.0.density=0.1"}).bodies.size() == 1);
}

TEST_CASE("a scene too far from the origin for single precision is refused", "[scene]")
{
    const auto shifted = [](const std::string& from, const std::string& to) {
        return std::vector<std::string>{"fluids.0.blocks.0={\"min\":[" + from + ",0,0],\"max\":[" + to + ",1,0.4]}",
                                        "walls.0.box={\"min\":[" + from + ",0,0],\"max\":[" + to + ",1,1]}",
                                        "bodies=[]"};
    };
    check_refused(kCrate, shifted("6000", "6001"), {"6001 m away", "100000 particle spacings (5000 m)"});
    CHECK(checked(kCrate, shifted("4000", "4001")).fluid_particles > 3000.0);
}

TEST_CASE("probes where no water can come are noted", "[scene]")
{
    const SceneCheck check = checked(kRaft, {"probes.0.pressure=[5,5]", "probes.1.level=[-1]"});
    CHECK(has_note(check, "probes[0] (\"floor\") is outside"));
    CHECK(has_note(check, "probes[1] (\"surface\") is outside"));
    CHECK_FALSE(has_note(checked(kRaft), "probes"));
    CHECK_FALSE(has_note(checked(kRaft, {"probes.0.pressure=[0.5,0.7]"}), "probes")); // above the water, in the tank
}

TEST_CASE("mesh files are checked where a scene names them", "[scene]")
{
    const TemporaryDirectory directory("flotsam_check_scene");
    const auto scene = directory.path() / "scene.json";
    const auto with_mesh = [](const std::string& file) {
        return std::vector<std::string>{"bodies.0.shape={\"mesh\":{\"file\":\"" + file + "\",\"scale\":0.3}}",
                                        "bodies.0.position=[0.3,0.3,0.5]"};
    };
    directory.write("good.obj", tetrahedron());
    directory.write("open.obj", tetrahedron(""));
    directory.write("inverted.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
    directory.write("nan.obj", "v 0 0 nan\n" + tetrahedron());
    directory.write("empty.obj", "");

    const SceneCheck good = checked(kCrate, with_mesh("good.obj"), scene);
    CHECK(good.bodies.at(0).volume == Approx(0.3 * 0.3 * 0.3 / 6.0));
    const SceneCheck inverted = checked(kCrate, with_mesh("inverted.obj"), scene);
    CHECK(inverted.bodies.at(0).volume == Approx(good.bodies.at(0).volume));
    CHECK(has_note(inverted, "inverted.obj"));
    check_refused(kCrate, with_mesh("open.obj"), {"open.obj", "open"}, scene);
    check_refused(kCrate, with_mesh("empty.obj"), {"empty.obj"}, scene);
    check_refused(kCrate, with_mesh("missing.obj"), {"missing.obj"}, scene);
    check_refused(kCrate, with_mesh("nan.obj"), {"nan.obj"}, scene);
    check_refused(kCrate, with_mesh("missing.obj"), {"scene.json: bodies[0].shape.mesh: "}, scene);
    check_refused(kCrate, {"fluids.0.meshes=[{\"file\":\"open.obj\"}]"}, {"scene.json: fluids[0].meshes[0]: "}, scene);
    check_refused(kCrate, {"walls=[{\"mesh\":{\"file\":\"nan.obj\"}}]"}, {"scene.json: walls[0].mesh: "}, scene);
    check_refused(kCrate, {"walls=[{\"mesh\":{\"file\":\"good.obj\",\"scale\":0.001}}]"},
                  {"walls[0].mesh: ", "0.001 x 0.001 x 0.001 m", "scale"}, scene);
    const std::string away = "fluids.0.meshes=[{\"file\":\"good.obj\",\"position\":[5,0,0]}]";
    CHECK(has_note(checked(kCrate, {away}, scene), "fluids[0].meshes[0] lies outside the walls"));
    const std::string parts = "bodies.0.shape={\"compound\":[{\"sphere\":0.1},{\"mesh\":{\"file\":\"open.obj\"}}]}";
    check_refused(kCrate, {parts}, {"bodies[0].shape.compound[1].mesh: "}, scene);
}

TEST_CASE("a mesh file is checked by itself", "[scene]")
{
    const TemporaryDirectory directory("flotsam_check_mesh_file");
    directory.write("good.obj", tetrahedron());
    directory.write("inverted.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
    directory.write("open.obj", tetrahedron(""));
    directory.write("nan.obj", "v 0 0 nan\n" + tetrahedron("f 2 3 5\n"));

    const MeshFileCheck good = check_mesh_file(directory.path() / "good.obj");
    CHECK(good.notes.empty());
    CHECK(good.triangles == 4);
    CHECK(good.parts == 1);
    CHECK(good.volume == Approx(1.0 / 6.0));
    CHECK(good.center_of_mass.isApprox(Vec3d::Constant(0.25)));
    CHECK(good.bounds.max == Vec3d::Ones());
    CHECK(check_mesh_file(directory.path() / "inverted.obj").notes.size() == 1);
    const auto sentence = [&](const char* file) {
        return refusal([&] { (void)check_mesh_file(directory.path() / file); });
    };
    CHECK(sentence("open.obj").find("it can be a wall only") != std::string::npos);
    CHECK(sentence("nan.obj").find("nan") != std::string::npos);
    CHECK(sentence("nan.obj").find("wall") == std::string::npos);
    CHECK(sentence("missing.obj").find("no such file") != std::string::npos);
}

TEST_CASE("mesh walls hold bodies in or out", "[scene]")
{
    const TemporaryDirectory directory("flotsam_check_walls");
    const auto scene = directory.path() / "scene.json";
    directory.write("corner.obj", tetrahedron());
    const auto with_wall = [](const std::string& wall, const std::string& position) {
        return std::vector<std::string>{"walls=[{\"mesh\":" + wall + "}]", "bodies.0.position=" + position,
                                        "fluids.0.blocks.0.max=[0.4,0.4,0.2]"};
    };
    const std::string tank = "{\"file\":\"corner.obj\",\"scale\":3}";
    CHECK(refusal([&] { (void)checked(kCrate, with_wall(tank, "[0.5,0.5,0.5]"), scene); }).empty());
    check_refused(kCrate, with_wall(tank, "[2,2,2]"), {"\"crate\"", "outside the tank"}, scene);
    check_refused(kCrate, with_wall(tank, "[0.05,0.5,0.5]"), {"(\"crate\") overlaps walls[0]"}, scene);

    const std::string rock = "{\"file\":\"corner.obj\",\"position\":[0.45,0.45,0]}";
    check_refused(kCrate, with_wall(rock, "[0.6,0.6,0.2]"), {"(\"crate\") overlaps walls[0]"}, scene);
    CHECK(refusal([&] { (void)checked(kCrate, with_wall(rock, "[1.2,1.2,0.6]"), scene); }).empty());
}

TEST_CASE("compounds add up, and their parts may only touch", "[scene]")
{
    const auto compound = [](const std::string& z) {
        return "bodies.0.shape={\"compound\":[{\"box\":[0.2,0.2,0.2]},{\"box\":[0.1,0.1,0.2],\"position\":[0,0," + z +
               "]}]}";
    };
    const SceneCheck check = checked(kCrate, {compound("0.2"), "bodies.0.position=[0.5,0.5,0.6]"});
    CHECK(check.bodies.at(0).volume == Approx(0.01));
    check_refused(kCrate, {compound("0.1"), "bodies.0.position=[0.5,0.5,0.6]"}, {"\"crate\"", "compound overlap"});
    check_refused(kCrate, {"bodies.0.shape={\"compound\":[{\"box\":[0.2,0.2,0.2]},{\"box\":[0.2,0.2,0.2]}]}"},
                  {"\"crate\"", "parts 0 and 1", "compound overlap"});
}

TEST_CASE("the scenes of the repository pass", "[scene]")
{
    int scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(FLOTSAM_DATA_DIR "/scenes")) {
        if (entry.path().extension() != ".json") continue;
        INFO(entry.path().string());
        CHECK(check_scene(read_scene(entry.path())).fluid_particles > 1000.0);
        ++scenes;
    }
    CHECK(scenes >= 7);
}

TEST_CASE("a centre of mass outside of its body is refused", "[scene]")
{
    check_refused(kCrate, {"bodies.0.center_of_mass=[0,0,0.2]"}, {"\"crate\"", "center_of_mass", "[0, 0, 0.2]"});
    CHECK(checked(kCrate, {"bodies.0.center_of_mass=[0,0,0.1]"}).bodies.size() == 1);
}

TEST_CASE("a closed tank filled from a mesh that touches it holds the water", "[scene]")
{
    const TemporaryDirectory directory("flotsam_filled_tank");
    directory.write("tank.obj", tetrahedron());
    const std::string text = R"({
      "flotsam": 1, "particle_spacing": 0.05, "duration": 0.1,
      "fluids": [{"meshes": [{"file": "tank.obj"}]}],
      "walls": [{"mesh": {"file": "tank.obj"}}],
      "bodies": [{"name": "ball", "shape": {"sphere": 0.1}, "density": 500, "position": [0.2, 0.2, 0.2]}]
    })";
    CHECK(checked(text, {}, directory.path() / "scene.json").bodies.size() == 1);
}

TEST_CASE("tanks that are too close to each other are refused by name", "[scene]")
{
    const std::string left = R"({"name": "left", "box": {"min": [0, 0], "max": [1, 0.8], "open": ["+z"]}})";
    const auto right = [](const std::string& from) {
        return R"({"name": "right", "box": {"min": [)" + from + R"(, 0], "max": [2, 0.8], "open": ["+z"]}})";
    };
    for (const std::string from : {"1", "1.06"})
        check_refused(kRaft, {"walls=[" + left + "," + right(from) + "]"},
                      {"walls[0] (\"left\") and walls[1] (\"right\")", "4 particle spacings (80 mm)"});
    CHECK(checked(kRaft, {"walls=[" + left + "," + right("1.08") + "]"}).bodies.size() == 1);
    check_refused(kRaft, {"walls=[" + left + "," + right("1.08") + "]", "bodies.raft.position=[0.9,0.3]"},
                  {"\"raft\"", "overlaps walls[0]", "+x side"});
}
