#include "scene_texts.hpp"
#include "support/catch.hpp"

#include <filesystem>
#include <fstream>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

/// A text with the first `from` replaced.
std::string changed(std::string text, const std::string& from, const std::string& to)
{
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

void check_contains(const std::string& sentence, const std::vector<std::string>& parts)
{
    for (const std::string& part : parts) {
        INFO("sentence: " << sentence);
        CHECK(sentence.find(part) != std::string::npos);
    }
}

} // namespace

TEST_CASE("a scene is read with its defaults", "[scene]")
{
    const SceneFile scene = parsed(kCrate);
    CHECK(scene.dimensions == 3);
    CHECK(scene.gravity == Vec3d(0, 0, -9.81));
    CHECK(scene.max_time_step == 0.004);
    CHECK(scene.cfl == 0.4);
    CHECK(scene.pressure.source == PressureSettings::Source::split);
    CHECK(scene.start == FluidWorldSettings::Start::as_given);
    CHECK(scene.fluid.density == 1000.0);
    REQUIRE(scene.fluid.blocks.size() == 1);
    CHECK(scene.fluid.blocks[0].box.max == Vec3d(1, 1, 0.4));
    REQUIRE(scene.walls.size() == 1);
    CHECK(scene.walls[0].open == std::vector<std::string>{"+z"});
    REQUIRE(scene.bodies.size() == 1);
    CHECK(scene.bodies[0].name == "crate");
    CHECK(std::get<BoxShape>(scene.bodies[0].parts.at(0).shape).edges == Vec3d(0.2, 0.2, 0.2));
    CHECK(scene.bodies[0].friction == 0.5);
    CHECK_FALSE(scene.output.vtk);
    CHECK_FALSE(scene.output.pictures);
}

TEST_CASE("every key of the format is read", "[scene]")
{
    const SceneFile scene = parsed(R"({ "flotsam": 1, "dimensions": 3, "particle_spacing": 0.02, "gravity": [0,0,-1],
      "duration": 3.0, "time_step": {"max": 0.002, "cfl": 0.3},
      "pressure": {"solver": "mprgp", "source": "published", "coupling": "weak", "tolerance": 0.01,
                   "velocity_tolerance": 0.02, "max_iterations": 50},
      "fluids": [{"name": "oil", "density": 900, "kinematic_viscosity": 1e-4,
                  "blocks": [{"min": [0,0,0], "max": [1,1,0.4], "velocity": [1,2,3]}],
                  "meshes": [{"file": "pond.obj", "up": "y", "position": [1,0,0], "velocity": [0,0,1]}]}],
      "walls":  [{"name": "basin", "box": {"min": [0,0,0], "max": [1,1,1], "open": ["+z", "-x"]}},
                 {"mesh": {"file": "tank.stl", "scale": 0.001, "side": "both", "rotation_deg": [0, 0, 90]}}],
      "bodies": [{"name": "hull", "shape": {"mesh": {"file": "../hull.obj", "scale": 2, "up": "x"}}, "mass": 12.5,
                  "position": [0.5,0.5,0.45], "rotation_deg": [0,5,0], "velocity": [1,0,0], "friction": 0.1,
                  "angular_velocity": [0,0,2], "lock": ["y","ry"], "center_of_mass": [0,0,0.05], "inertia": [1,2,2.5]},
                 {"name": "post", "shape": {"compound": [{"cylinder": [0.1, 1]}, {"sphere": 0.2, "position": [0,0,0.6]}]},
                  "motion": "fixed"},
                 {"name": "gate", "shape": {"box": [1,1,1]}, "motion": "moving", "velocity": [0,0,1]}],
      "joints": [],
      "probes": [{"name": "p1", "pressure": [0.9,0.5,0.05]}, {"name": "h1", "level": [0.2,0.5]}],
      "output": {"frames_per_second": 25, "vtk": true, "pictures": {"width": 640, "height": 480, "every": 3,
                 "camera": {"position": [3,3,3], "look_at": [0,0,0], "fov_deg": 50}}} })");
    CHECK(scene.gravity.z() == -1.0);
    CHECK(scene.max_time_step == 0.002);
    CHECK(scene.cfl == 0.3);
    CHECK(scene.pressure.solver == PressureSettings::Solver::mprgp);
    CHECK(scene.pressure.source == PressureSettings::Source::published);
    CHECK(scene.pressure.coupling == PressureSettings::Coupling::weak);
    CHECK(scene.pressure.tolerance == 0.01);
    CHECK(scene.pressure.velocity_tolerance == 0.02);
    CHECK(scene.pressure.max_iterations == 50);
    CHECK(scene.fluid.name == "oil");
    CHECK(scene.fluid.kinematic_viscosity == 1e-4);
    CHECK(scene.fluid.blocks.at(0).velocity == Vec3d(1, 2, 3));
    CHECK(scene.fluid.meshes.at(0).mesh.file == "dir/pond.obj");
    CHECK(scene.fluid.meshes.at(0).mesh.options.up == MeshFileOptions::UpAxis::y);
    CHECK(scene.fluid.meshes.at(0).velocity == Vec3d(0, 0, 1));
    CHECK(scene.walls.at(0).name == "basin");
    CHECK(scene.walls.at(1).mesh->options.scale == 0.001);
    CHECK(scene.walls.at(1).side == WallSide::both);
    CHECK((scene.walls.at(1).pose.orientation * Vec3d::UnitX()).isApprox(Vec3d::UnitY()));
    const SceneBody& hull = scene.bodies.at(0);
    CHECK(std::get<SceneMesh>(hull.parts.at(0).shape).file == "hull.obj");
    CHECK(hull.mass == 12.5);
    CHECK(hull.lock == std::array<bool, 6>{false, true, false, false, true, false});
    CHECK(hull.center_of_mass == Vec3d(0, 0, 0.05));
    CHECK(hull.inertia == Vec3d(1, 2, 2.5));
    CHECK(hull.angular_velocity == Vec3d(0, 0, 2));
    CHECK(scene.bodies.at(1).parts.size() == 2);
    CHECK(scene.bodies.at(1).parts[1].pose.position.z() == 0.6);
    CHECK(scene.bodies.at(2).motion == SceneBody::Motion::moving);
    CHECK(scene.probes.at(1).kind == SceneProbe::Kind::level);
    CHECK(scene.output.vtk);
    CHECK(scene.output.pictures->every == 3);
    CHECK(scene.output.pictures->camera->fov_deg == 50.0);
}

TEST_CASE("2-D scenes take vectors of the plane", "[scene]")
{
    const SceneFile scene = parsed(kRaft);
    CHECK(scene.bodies[0].pose.position == Vec3d(0.5, 0, 0.3));
    CHECK(std::get<BoxShape>(scene.bodies[0].parts[0].shape).edges == Vec3d(0.3, 1.0, 0.1));
    CHECK(scene.walls[0].open == std::vector<std::string>{"+y", "+z", "-y"});
    CHECK(parsed(kRaft, {"bodies.raft.position=[0.5,0,0.3]"}).bodies[0].pose.position.z() == 0.3);
    check_contains(refusal_of(kRaft, {"bodies.raft.position=[0.5,0.1,0.3]"}), {"bodies[0].position", "y = 0"});
    check_contains(refusal_of(kRaft, {"bodies.raft.shape={\"sphere\":0.1}"}), {"bodies[0].shape.sphere", "disc"});
    check_contains(refusal_of(kCrate, {"bodies.0.shape={\"disc\":0.1}"}), {"bodies[0].shape.disc", "two dimensions"});
    check_contains(refusal_of(kRaft, {"bodies.raft.rotation_deg=[1,0,0]"}), {"bodies[0].rotation_deg", "about y"});
    check_contains(refusal_of(kRaft, {"bodies.raft.shape.box=[1,1,1]"}), {"bodies[0].shape.box", "[x, z]"});
}

TEST_CASE("bad scenes are refused with the place and what is allowed", "[scene]")
{
    struct Case {
        const char* from;
        const char* to;
        std::vector<std::string> parts;
    };
    const Case each = GENERATE(values<Case>({
        {"\"density\"", "\"densty\"", {"bodies[0].densty", "unknown key", "\"density\""}},
        {"\"particle_spacing\"", "\"particle_spacnig\"", {"particle_spacnig", "\"particle_spacing\""}},
        {"\"open\"", "\"opened\"", {"walls[0].box.opened", "\"open\""}},
        {"\"flotsam\": 1", "\"flotsam\": 2", {"flotsam", "must be 1", "given 2"}},
        {"\"flotsam\": 1, ", "", {"lacks the required key \"flotsam\""}},
        {"\"duration\": 0.1,", "", {"lacks the required key \"duration\""}},
        {"\"duration\": 0.1", "\"duration\": -1", {"duration must be a number > 0 [s]", "given -1"}},
        {"\"duration\": 0.1", "\"duration\": 0", {"duration must be a number > 0 [s]"}},
        {"0.05", "-0.05", {"particle_spacing must be a number > 0 [m]", "given -0.05"}},
        {"0.05", "\"small\"", {"particle_spacing must be a number > 0 [m]", "given \"small\""}},
        {"0.05", "1e999", {"line 2, column", "near particle_spacing", "1e999", "finite"}},
        {"0.05", "NaN", {"line 2, column", "near particle_spacing", "not JSON", "finite, given NaN"}},
        {"0.5, 0.5, 0.4", "0.5, -Infinity", {"near bodies[0].position[1]: not JSON", "finite, given -Infinity"}},
        {"0.05", "1e10", {"particle_spacing must be a number of at most 1e+09 [m]"}},
        {"500", "500, \"motion\": \"moving\"", {"bodies[0] is moving and must have \"velocity\""}},
        {"\"crate\"", "\" \"", {"bodies[0].name must not begin or end with a space"}},
        {"\"crate\"", "\"a\\tb\"", {"bodies[0].name must be free of commas"}},
        {"500", "500, \"mass\": 3", {"bodies[0]", "both \"density\" and \"mass\""}},
        {"\"density\": 500, ", "", {"bodies[0]", "\"density\" or \"mass\""}},
        {"500", "0", {"bodies[0].density must be a number > 0 [kg/m^3]"}},
        {"500", "500, \"density\": 400", {"bodies[0].density is there twice"}},
        {"[0.5, 0.5, 0.4]", "[0.5, 0.4]", {"bodies[0].position", "3 numbers"}},
        {"[0.5, 0.5, 0.4]", "[0.5, null, 0.4]", {"bodies[0].position[1]", "given null"}},
        {"[0.2, 0.2, 0.2]", "[0.2, 0, 0.2]", {"bodies[0].shape.box[1] must be a number > 0 [m]"}},
        {"\"box\": [0.2", "\"sphere\": 1, \"box\": [0.2", {"bodies[0].shape", "both \"box\" and \"sphere\""}},
        {"\"shape\": {\"box\": [0.2, 0.2, 0.2]}", "\"shape\": {}", {"bodies[0].shape", "\"box\", \"sphere\""}},
        {"\"+z\"", "\"up\"", {"walls[0].box.open[0]", "\"+z\"", "given \"up\""}},
        {"[{\"blocks\": [{\"min\": [0, 0, 0], \"max\": [1, 1, 0.4]}]}]", "[]", {"fluids has no fluid"}},
        {"{\"min\": [0, 0, 0], \"max\": [1, 1, 0.4]}", "", {"fluids[0] has no fluid"}},
        {"[1, 1, 0.4]", "[1, 0, 0.4]", {"fluids[0].blocks[0]", "above"}},
        {"\"fluids\": [", "\"fluids\": [{}, ", {"fluids has 2 entries", "one fluid"}},
        {"\"fluids\": [", "\"fluids\": 3, \"x\": [", {"x is an unknown key"}},
        {"\"crate\"", "\"\"", {"bodies[0].name must be a text"}},
        {"\"duration\"", "\"dimensions\": 4, \"duration\"", {"dimensions must be 2 or 3"}},
        {"\"duration\"", "\"dimensions\": 2.5, \"duration\"", {"dimensions must be 2 or 3"}},
        {"\"duration\"", "\"start\": \"still\", \"duration\"", {"start must be", "at_rest", "given \"still\""}},
        {"\"duration\"", "\"start\": true, \"duration\"", {"start must be", "as_given", "given true"}},
        {"\"duration\"", "\"output\": null, \"duration\"", {"output must be an object"}},
    }));
    check_contains(refusal_of(changed(kCrate, each.from, each.to)), each.parts);
    check_contains(refusal_of(changed(kCrate, each.from, each.to)), {"test.json"});
}

TEST_CASE("settings out of their range are refused", "[scene]")
{
    CHECK_FALSE(refusal_of(kCrate, {"time_step.cfl=1.5"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"time_step.cfl=0"}).empty());
    CHECK(refusal_of(kCrate, {"time_step.cfl=1"}).empty());
    check_contains(refusal_of(kCrate, {"time_step.cfl=2"}), {"time_step.cfl must be", "from 0.001 to 1"});
    check_contains(refusal_of(kCrate, {"time_step.max=1e9"}), {"time_step.max must be", "at most 1000"});
    check_contains(refusal_of(kCrate, {"pressure.tolerance=1e9"}), {"pressure.tolerance must be", "to 0.5"});
    check_contains(refusal_of(kCrate, {"time_step.cfl=1e-300"}), {"time_step.cfl must be", "from 0.001 to 1"});
    check_contains(refusal_of(kCrate, {"bodies.0.shape={\"sphere\":1e-300}"}), {"sphere must be", "from 1e-09"});
    CHECK_FALSE(refusal_of(kCrate, {"pressure.tolerance=0"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"pressure.max_iterations=0"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"pressure.solver=jacobi"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"fluids.0.kinematic_viscosity=-1"}).empty());
    CHECK(refusal_of(kCrate, {"fluids.0.kinematic_viscosity=0"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"output.frames_per_second=0"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"output.pictures.width=0"}).empty());
    CHECK(refusal_of(kCrate, {"output.pictures=true"}).empty());
    CHECK(refusal_of(kCrate, {"start=as_given"}).empty());
    CHECK(refusal_of(kCrate, {"start=at_rest"}).empty());
    check_contains(refusal_of(kCrate, {"start=at_rest", "fluids.0.blocks.0.velocity=[1,0,0]"}),
                   {"start must be \"as_given\" for fluid with a velocity"});
    CHECK(refusal_of(kCrate, {"start=at_rest", "fluids.0.blocks.0.velocity=[0,0,0]"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"bodies.crate.lock=[\"q\"]"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"bodies.crate.motion=still"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"bodies.crate.inertia=[1,1,3]"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"bodies.crate.motion=fixed", "bodies.crate.velocity=[1,0,0]"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"bodies.crate.motion=fixed", "bodies.crate.lock=[\"x\"]"}).empty());
    CHECK_FALSE(refusal_of(kCrate, {"bodies.crate.lock=[\"ry\"]", "bodies.crate.angular_velocity=[0,1,0]"}).empty());
    CHECK(refusal_of(kCrate, {"bodies.crate.lock=[\"ry\"]", "bodies.crate.angular_velocity=[1,0,0]"}).empty());
    CHECK_FALSE(refusal_of(kRaft, {"probes.0.name=raft"}).empty());
    check_contains(refusal_of(kCrate, {"gravity=[0,0,-1e5]"}), {"gravity[2] must be a number from -10000 to 10000"});
    check_contains(refusal_of(kCrate, {"bodies.crate.velocity=[0,0,2000]"}), {"bodies[0].velocity[2]", "[m/s]"});
    check_contains(refusal_of(kCrate, {"bodies.crate.angular_velocity=[0,0,1e5]"}), {"angular_velocity[2]", "[rad/s]"});
    check_contains(refusal_of(kCrate, {"bodies.crate.position=[0,0,1e300]"}), {"bodies[0].position[2]", "1e+09 [m]"});
    check_contains(refusal_of(kCrate, {"fluids.0.density=1e9"}), {"fluids[0].density must be a number from 0.001 to"});
    check_contains(refusal_of(kCrate, {"output.pictures.width=10000"}), {"pictures.width", "from 16 to 8192"});
    check_contains(refusal_of(kCrate, {"duration=1e8", "output.frames_per_second=1e-3"}), {"duration must be at most"});
}

TEST_CASE("a rotation of many turns is that of what is left of them", "[scene]")
{
    const Quatd turned = parsed(kCrate, {"bodies.crate.rotation_deg=[0,36000030,0]"}).bodies[0].pose.orientation;
    const Quatd once = parsed(kCrate, {"bodies.crate.rotation_deg=[0,30,0]"}).bodies[0].pose.orientation;
    CHECK(turned.angularDistance(once) < 1e-12);
    CHECK(turned.angularDistance(Quatd::Identity()) == Approx(30.0 * 3.14159265358979 / 180.0));
}

TEST_CASE("a value given with --set is changed before anything is checked", "[scene]")
{
    CHECK(parsed(kCrate, {"bodies.0.density=300"}).bodies[0].density == 300.0);
    CHECK(parsed(kCrate, {"bodies[0].density=300"}).bodies[0].density == 300.0);
    CHECK(parsed(kCrate, {"bodies.crate.density=300"}).bodies[0].density == 300.0);
    CHECK(parsed(kCrate, {"bodies.crate.name=box"}).bodies[0].name == "box");
    CHECK(parsed(kCrate, {"bodies.crate.shape.box.1=0.3"}).bodies[0].parts.size() == 1);
    CHECK(parsed(kCrate, {"time_step.max=0.001"}).max_time_step == 0.001);
    CHECK(parsed(kCrate, {"output.vtk=true", "output.frames_per_second=10"}).output.vtk);

    check_contains(refusal_of(kCrate, {"bodies.crat.density=3"}), {"bodies.crat.density", "\"crate\""});
    check_contains(refusal_of(kCrate, {"bodies.7.density=3"}), {"--set bodies.7.density=3", "1 entries"});
    check_contains(refusal_of(kCrate, {"bodies.0.densty=3"}), {"bodies[0].densty", "\"density\""});
    check_contains(refusal_of(kCrate, {"duration.max=3"}), {"--set duration.max=3", "no \"max\""});
    check_contains(refusal_of(kCrate, {"duration"}), {"--set duration", "path=value"});
    check_contains(refusal_of(kCrate, {"duration=nan"}), {"duration must be a number", "\"nan\""});
    check_contains(refusal_of(kCrate, {"duration=1e999"}), {"--set duration=1e999", "finite"});
    check_contains(refusal_of(kCrate, {"bodies.0.position=[1,2"}), {"--set bodies.0.position=[1,2", "not JSON"});
}

TEST_CASE("files that are no scenes are refused", "[scene]")
{
    const auto directory = std::filesystem::temp_directory_path();
    check_contains(refusal([&] { (void)read_scene(directory / "no_such_scene.json"); }),
                   {"no_such_scene.json", "no such scene file"});
    check_contains(refusal([&] { (void)read_scene(directory); }), {"directory"});
    check_contains(refusal([] { (void)read_scene(""); }), {"empty name"});
    check_contains(refusal([] { (void)read_scene("/dev/zero"); }), {"/dev/zero", "16 MB"});
    check_contains(refusal_of(""), {"line 1, column"});
    check_contains(refusal_of("{\n  \"flotsam\": 1,\n  oops\n}"), {"line 3, column", "not JSON"});
    check_contains(refusal_of("[1, 2]"), {"the scene must be an object"});
}

TEST_CASE("a deep file, a run without end and columns of one name are refused", "[scene]")
{
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    check_contains(refusal_of(changed(kRaft, "0.02", deep)), {"levels deep"});
    const std::string override_sentence = refusal_of(kRaft, {"duration=" + deep});
    check_contains(override_sentence, {"--set duration=", "levels deep"});
    CHECK(override_sentence.size() < 300);
    check_contains(refusal_of(kRaft, {"output.frames_per_second=1e9"}), {"duration", "a million frames"});
    check_contains(refusal_of(kRaft, {"duration=1e9", "time_step.max=1000"}), {"duration", "a million frames"});
    check_contains(refusal_of(kRaft, {"time_step.max=1e-12"}), {"time_step.max", "billionth"});
    check_contains(refusal_of(kRaft, {"probes.floor.name=t"}), {"two columns \"t\""});
    check_contains(refusal_of(kRaft, {"probes.floor.name=raft.x"}), {"two columns \"raft.x\""});
}
