#include "flotsam/scene/run_scene.hpp"
#include "scene_texts.hpp"
#include "support/catch.hpp"
#include "support_directory.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

using namespace flotsam;
using namespace flotsam::testing;

namespace {

struct Watcher final : RunObserver {
    int starts = 0, steps = 0;
    double time = 0.0;
    void on_start(std::size_t, std::size_t, const std::vector<std::string>&) override { ++starts; }
    void on_step(const RunProgress& progress) override
    {
        ++steps;
        time = progress.time;
    }
};

RunReport ran(const std::string& text, const std::vector<std::string>& overrides, const std::filesystem::path& out = {},
              int threads = 2)
{
    Watcher watcher;
    return run_scene(parse_scene(text, "test.json", overrides), {out, threads}, watcher);
}

std::vector<std::vector<std::string>> table(const std::string& csv)
{
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

} // namespace

TEST_CASE("a run reports what the format promises", "[scene][run]")
{
    const TemporaryDirectory directory("flotsam_run");
    const auto out = directory.path() / "out";
    Watcher watcher;
    const SceneFile scene = parsed(kRaft, {"output={\"frames_per_second\": 30, \"vtk\": true}"});
    const RunReport report = run_scene(scene, {out, 2}, watcher);
    CHECK(watcher.starts == 1);
    CHECK(watcher.steps == report.steps);
    CHECK(watcher.time == Approx(0.1));

    const auto json = nlohmann::json::parse(directory.read("out/report.json"));
    for (const char* key : {"version", "scene", "threads", "particles", "simulated_seconds", "steps", "wall_seconds",
                            "stage_seconds", "iterations", "unconverged_steps", "compression", "leaked",
                            "peak_memory_bytes", "state_hash", "ledger", "bodies", "probes"}) {
        INFO(key);
        CHECK(json.contains(key));
    }
    for (const char* key : {"name", "mass", "volume", "position", "rotation_deg", "velocity", "tilt_deg", "waterline",
                            "draft", "exact_draft", "force_fluid_mean", "torque_fluid_mean"}) {
        INFO(key);
        CHECK(json["bodies"][0].contains(key));
    }
    CHECK(json["particles"]["fluid"] == report.fluid_particles);
    CHECK(json["bodies"][0]["mass"].get<double>() == Approx(15.0));
    CHECK(json["probes"][0]["name"] == "floor");
    CHECK(json["state_hash"].get<std::string>().size() == 16);
    CHECK(json["ledger"]["momentum_error_relative"].get<double>() < 1e-5);
    for (const char* books : {"angular_momentum", "energy", "volume"}) {
        INFO(books);
        CHECK(json["ledger"][books]["error_relative"].get<double>() < 1e-5);
    }
    const auto& energy = json["ledger"]["energy"];
    CHECK(energy["kinetic_start"].get<double>() == 0.0);
    CHECK(energy["kinetic_end"].get<double>() > 0.0);
    CHECK(energy["bodies"]["pressure"].get<double>() != 0.0);
    CHECK(json["ledger"]["momentum"]["walls"]["pressure"][2].get<double>() < 0.0);

    const auto rows = table(directory.read("out/history.csv"));
    REQUIRE(rows.size() == 5); // the header, t = 0, two frames and the end
    CHECK(rows[0].size() == 1 + 18 + 2);
    CHECK(rows[0][1] == "raft.x");
    CHECK(rows[0][18] == "raft.tz");
    CHECK(rows[0][19] == "floor");
    CHECK(std::stod(rows[2][0]) == Approx(1.0 / 30.0).epsilon(1e-8));
    CHECK(std::stod(rows[4][0]) == Approx(0.1).epsilon(1e-8));
    for (const char* file :
         {"particles.pvd", "bodies.pvd", "vtk/particles_0003.vtp", "vtk/bodies_0003.vtp", "vtk/walls.vtp"})
        CHECK(std::filesystem::exists(out / file));
}

TEST_CASE("forces in the history add up to what a held body feels", "[scene][run]")
{
    // Held wholly under water: the force is the displaced weight, whatever the way it is averaged.
    const std::vector<std::string> held{"bodies.raft.position=[0.5,0.17]", "bodies.raft.motion=fixed", "duration=0.5"};
    const RunReport report = ran(kRaft, held);
    const double weight = 1000.0 * 9.81 * 0.3 * 0.1;
    CHECK(report.bodies.at(0).force_fluid_mean.z() == Approx(weight).epsilon(0.15)); // five spacings thick
    CHECK(report.bodies[0].position.z() == 0.17);
    CHECK(report.bodies[0].velocity.norm() == 0.0);
}

TEST_CASE("bodies fall, stay locked and move as the scene says", "[scene][run]")
{
    // Thrown up from above the water: nothing but gravity acts in a tenth of a second.
    const std::vector<std::string> flying{"bodies.raft.position=[0.5,0.6]", "bodies.raft.velocity=[0.5,1]"};
    const RunReport free = ran(kRaft, flying);
    CHECK(free.bodies.at(0).velocity.z() == Approx(1.0 - 0.981).epsilon(0.01));
    CHECK(free.bodies[0].position.x() == Approx(0.55).epsilon(0.001));
    const std::vector<std::string> locked{"bodies.raft.position=[0.5,0.6]", "bodies.raft.lock=[\"z\"]"};
    CHECK(ran(kRaft, locked).bodies.at(0).position.z() == Approx(0.6).epsilon(1e-12));
    auto moving = flying;
    moving.emplace_back("bodies.raft.motion=moving");
    const RunReport moved = ran(kRaft, moving);
    CHECK(moved.bodies.at(0).position.z() == Approx(0.7).epsilon(1e-6));
    CHECK(moved.bodies[0].position.x() == Approx(0.55).epsilon(1e-6));
}

TEST_CASE("a body's place is its centre of mass, its rotation that of the shape", "[scene][run]")
{
    // A compound whose principal axes are turned against the shape's
    const std::string text = R"({"flotsam": 1, "particle_spacing": 0.05, "duration": 0.02,
      "fluids": [{"blocks": [{"min": [0,0,0], "max": [0.5,0.5,0.2]}]}],
      "walls": [{"box": {"min": [0,0,0], "max": [1,1,2], "open": ["+z"]}}],
      "bodies": [{"name": "b", "mass": 2, "position": [0.5,0.5,1.2], "rotation_deg": [0,0,30],
        "shape": {"compound": [{"box": [0.4,0.1,0.1]}, {"box": [0.1,0.3,0.1], "position": [0.15,0.2,0]}]}}]})";
    const RunReport report = ran(text, {});
    const double c = 3.0 / 7.0; // of the volume in the second box
    const Vec3d center = Eigen::AngleAxisd(std::acos(-1.0) / 6.0, Vec3d::UnitZ()) * Vec3d(0.15 * c, 0.2 * c, 0.0);
    CHECK(report.bodies.at(0).position.x() == Approx(0.5 + center.x()).epsilon(1e-6));
    CHECK(report.bodies[0].position.y() == Approx(0.5 + center.y()).epsilon(1e-6));
    CHECK(report.bodies[0].rotation_deg.z() == Approx(30.0).epsilon(1e-6));
    CHECK(report.bodies[0].tilt_deg == Approx(0.0).margin(1e-5));
}

TEST_CASE("meshes of every kind come to rest on the floor", "[scene][run]")
{
    struct Case {
        const char* shape;
        double rests_at; ///< height of its centre of mass [m]
    };
    const Case each = GENERATE(values<Case>({
        {R"({"mesh": {"file": "ring_buoy.stl"}})", 0.035}, // not convex: the triangles themselves
        {R"({"mesh": {"file": "crate.glb"}})", 0.06},      // convex: its hull
        {R"({"cylinder": [0.1, 0.12]})", 0.06},            // Bullet's own
        {R"({"compound": [{"box": [0.2, 0.2, 0.1]}, {"box": [0.2, 0.2, 0.1], "position": [0, 0, 0.1]}]})", 0.1},
    }));
    const bool in_mesh = GENERATE(false, true);
    const TemporaryDirectory directory("flotsam_rest");
    directory.write("floor.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    const std::string wall = in_mesh ? R"({"mesh": {"file": ")" + (directory.path() / "floor.obj").string() + R"("}})"
                                     : R"({"box": {"min": [-1,-1,0], "max": [1,1,1], "open": ["+z"]}})";
    const std::string text = R"({"flotsam": 1, "particle_spacing": 0.04, "duration": 0.6,
      "fluids": [{"blocks": [{"min": [-0.9,-0.9,0], "max": [-0.8,-0.8,0.1]}]}], "walls": [)" +
                             wall + R"(], "bodies": [{"name": "b", "density": 1500, "position": [0.3,0.3,0.2],
      "shape": )" + each.shape +
                             "}]}";
    Watcher watcher;
    const RunReport report = run_scene(parse_scene(text, FLOTSAM_DATA_DIR "/meshes/scene.json"), {{}, 1}, watcher);
    INFO(each.shape << (in_mesh ? " on a mesh" : " in a box"));
    CHECK(report.bodies.at(0).position.z() == Approx(each.rests_at).margin(0.003));
    CHECK(report.bodies[0].velocity.norm() < 0.1); // mesh against mesh trembles
    CHECK(report.bodies[0].tilt_deg < 2.0);
}

TEST_CASE("the exact draft is that of the pose, and heavy bodies have none", "[scene][run]")
{
    const std::vector<std::string> flying{"bodies.raft.position=[0.5,0.6]", "duration=0.02"};
    CHECK(ran(kRaft, flying).bodies.at(0).exact_draft.value() == Approx(0.05));
    auto tall = flying;
    tall.emplace_back("bodies.raft.rotation_deg=[0,90,0]");
    const RunReport turned = ran(kRaft, tall);
    CHECK(turned.bodies.at(0).exact_draft.value() == Approx(0.15));
    CHECK(turned.bodies[0].tilt_deg == Approx(90.0));
    auto heavy = flying;
    heavy.emplace_back("bodies.raft.density=1100");
    CHECK_FALSE(ran(kRaft, heavy).bodies.at(0).exact_draft);
}

TEST_CASE("runs repeat whatever the number of threads", "[scene][run][determinism]")
{
    const std::uint64_t one = ran(kRaft, {}, {}, 1).state_hash;
    CHECK(ran(kRaft, {}, {}, 3).state_hash == one);
    CHECK(ran(kRaft, {"gravity=[0,-9]"}, {}, 1).state_hash != one);
}

TEST_CASE("a refused scene leaves an older output alone", "[scene][run]")
{
    const TemporaryDirectory directory("flotsam_refused");
    const auto out = directory.path() / "out";
    (void)ran(kRaft, {"duration=0.01"}, out);
    const std::string before = directory.read("out/report.json");
    REQUIRE_FALSE(before.empty());
    CHECK_FALSE(refusal([&] { (void)ran(kRaft, {"bodies.raft.position=[3,3]"}, out); }).empty());
    CHECK(directory.read("out/report.json") == before);
    std::filesystem::create_directories(directory.path() / "mine");
    directory.write("mine/letter.txt", "dear");
    CHECK_FALSE(refusal([&] { (void)ran(kRaft, {"duration=0.01"}, directory.path() / "mine"); }).empty());
    CHECK(directory.read("mine/letter.txt") == "dear");
}

TEST_CASE("a report is JSON whatever is in it", "[scene]")
{
    RunReport report;
    report.bodies.resize(1);
    report.bodies[0].mass = std::nan("");
    report.bodies[0].velocity = Vec3d::Constant(std::numeric_limits<double>::infinity());
    report.failure = "came apart";
    const auto json = nlohmann::json::parse(report_as_json(report));
    CHECK(json["bodies"][0]["mass"].is_null());
    CHECK(json["bodies"][0]["draft"].is_null());
    CHECK(json["failure"] == "came apart");
}

TEST_CASE("a time step that falls to nothing ends the run", "[scene][run]")
{
    CHECK_THROWS_WITH(ran(kRaft, {"fluids.0.kinematic_viscosity=1000", "duration=100"}),
                      Catch::Contains("the time step fell to"));
}

TEST_CASE("drafts are reported where gravity points down only", "[scene][run]")
{
    const RunReport down = ran(kRaft, {});
    REQUIRE(down.bodies.at(0).waterline);
    CHECK(down.bodies[0].exact_draft);
    const RunReport free = ran(kRaft, {"gravity=[0,0]"});
    CHECK_FALSE(free.bodies.at(0).waterline);
    CHECK_FALSE(free.bodies[0].draft);
    CHECK_FALSE(free.bodies[0].exact_draft);
}

TEST_CASE("two tanks side by side have water lines and forces of their own", "[scene][run]")
{
    // One block goes through both, and what is between them is cut away.
    const std::string text = R"({"flotsam": 1, "dimensions": 2, "particle_spacing": 0.02, "duration": 0.4,
      "start": "at_rest", "fluids": [{"blocks": [{"min": [0, 0], "max": [1.1, 0.2]},
        {"min": [0, 0.2], "max": [0.4, 0.3]}]}],
      "walls": [{"name": "left", "box": {"min": [0, 0], "max": [0.4, 0.6], "open": ["+z"]}},
                {"name": "right", "box": {"min": [0.5, 0], "max": [1.1, 0.6], "open": ["+z"]}}],
      "bodies": [{"name": "a", "shape": {"box": [0.18, 0.1]}, "density": 500, "position": [0.2, 0.3]},
                 {"name": "b", "shape": {"box": [0.18, 0.1]}, "density": 500, "position": [0.8, 0.2]}]})";
    const RunReport report = ran(text, {});
    CHECK(report.leaked == 0);
    const double rho_g = 1000.0 * 9.81;
    // To half a spacing of the lattice; what bodies displace is cut away.
    CHECK(report.bodies.at(0).waterline.value() == Approx(0.3).margin(0.01));
    CHECK(report.bodies.at(1).waterline.value() == Approx(0.2).margin(0.01));
    for (const BodyReport& body : report.bodies) {
        CHECK(body.draft.value() == Approx(0.05).margin(0.01));
        CHECK(body.exact_draft.value() == Approx(0.05).margin(0.003)); // a degree of tilt lowers a corner by 1.6 mm
    }
    // Each bears its own water and body; the swell of a tenth of a second leaves some per cent
    CHECK(-report.wall_force_mean.at(0).z() == Approx(rho_g * 0.4 * 0.3).epsilon(0.05));
    CHECK(-report.wall_force_mean.at(1).z() == Approx(rho_g * 0.6 * 0.2).epsilon(0.05));
    CHECK(std::abs(report.wall_force_mean[0].x()) < 0.05 * rho_g * 0.4 * 0.3);
    CHECK(std::abs(report.wall_force_mean[1].x()) < 0.05 * rho_g * 0.6 * 0.2);
}

TEST_CASE("boxes that overlap bound one tank together", "[scene][run]")
{
    const auto particles = [&](const std::string& walls) {
        return ran(kRaft, {"walls=" + walls, "bodies=[]", "probes=[]", "duration=0.01"}).fluid_particles;
    };
    const std::string inner = R"({"box": {"min": [0.2, 0], "max": [0.8, 0.8], "open": ["+z"]}})";
    const std::string outer = R"({"box": {"min": [0, 0], "max": [1, 0.8], "open": ["+z"]}})";
    const std::string right = R"({"box": {"min": [0.5, 0], "max": [1, 0.8], "open": ["+z"]}})";
    CHECK(particles("[" + inner + "]") == 30 * 15);
    CHECK(particles("[" + inner + "," + outer + "]") == 30 * 15);
    CHECK(particles("[" + inner + "," + right + "]") == 15 * 15);
}

TEST_CASE("blocks of fluid that overlap fill their union once", "[scene][run]")
{
    const std::string first = R"({"min": [0, 0], "max": [0.4, 0.3]})",
                      second = R"({"min": [0.2, 0.1], "max": [0.6, 0.3]})";
    const RunReport report = ran(kRaft, {"bodies=[]", "fluids.0.blocks=[" + first + "," + second + "]"});
    CHECK(report.fluid_particles == 300 + 100);
    CHECK(report.compression.max < 0.2); // a burst had more
    REQUIRE(report.notes.size() == 1);
    CHECK(report.notes[0].find("100 fluid particles lay in an earlier block") == 0);
}

/// A box of sheet metal without lid, 0.3 x 0.2 x 0.12 m and 3 kg, its middle at the given height, in 0.16 m of water.
std::string tub_text(const TemporaryDirectory& directory, double height, const std::string& start)
{
    const TriangleMesh mesh = test_meshes::open_shell(Vec3d(-0.15, -0.1, -0.06), Vec3d(0.15, 0.1, 0.06), 0.01);
    std::ostringstream file, text;
    for (const Vec3d& v : mesh.vertices) file << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
    for (const auto& t : mesh.triangles) file << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    directory.write("tub.obj", file.str());
    text << R"({"flotsam": 1, "dimensions": 3, "particle_spacing": 0.02, "duration": 0.02, "start": ")" << start
         << R"(", "fluids": [{"name": "water", "blocks": [{"min": [0, 0, 0], "max": [0.8, 0.6, 0.16]}]}],
        "walls": [{"box": {"min": [0, 0, 0], "max": [0.8, 0.6, 0.5], "open": ["+z"]}}],
        "bodies": [{"name": "tub", "shape": {"mesh": {"file": ")"
         << (directory.path() / "tub.obj").string() << R"("}}, "mass": 3, "position": [0.4, 0.3, )" << height << "]}]}";
    return text.str();
}

TEST_CASE("the exact draft of a vessel counts her hollow, and the water in her", "[scene][run]")
{
    const TemporaryDirectory directory("flotsam_test_vessel");
    const RunReport falling = ran(tub_text(directory, 0.4, "as_given"), {});
    CHECK(falling.bodies.at(0).exact_draft.value() == Approx(0.05).epsilon(1e-4));
    // With water put into her, a layer of 0.04 m.
    const RunReport loaded = ran(
        tub_text(directory, 0.18, "as_given"),
        {R"(fluids.0.blocks=[{"min":[0,0,0],"max":[0.8,0.6,0.12]},{"min":[0.27,0.22,0.14],"max":[0.53,0.38,0.18]}])"});
    CHECK(loaded.bodies.at(0).exact_draft.value() == Approx((3.0 + 0.26 * 0.16 * 40.0) / 60.0).epsilon(0.05));
}

TEST_CASE("a vessel of sheet metal starts at rest afloat and dry", "[scene][run]")
{
    const TemporaryDirectory directory("flotsam_test_vessel_at_rest");
    const RunReport report = ran(tub_text(directory, 0.4, "at_rest"), {});
    CHECK(report.bodies.at(0).draft.value() == Approx(0.05).margin(0.01));
    const auto noted = [&](const std::string& words) {
        return std::any_of(report.notes.begin(), report.notes.end(),
                           [&](const std::string& note) { return note.find(words) != std::string::npos; });
    };
    CHECK(noted("bodies[0] (\"tub\") was moved down by 230 mm to where it floats"));
    CHECK(noted("bodies[0] (\"tub\") starts dry: "));
}

TEST_CASE("a light body that deep water presses to a wall is not thrown off it", "[scene][run]")
{
    // Of a twentieth of a particle's mass for each spacing of its width, 0.3 spacings from the wall.
    const std::string text = R"({"flotsam": 1, "dimensions": 2, "particle_spacing": 0.01, "duration": 0.1,
        "fluids": [{"name": "water", "blocks": [{"min": [0, 0], "max": [0.3, 0.4]}]}],
        "walls": [{"box": {"min": [0, 0], "max": [0.3, 0.6], "open": ["+z"]}}],
        "bodies": [{"name": "square", "shape": {"box": [0.1, 0.1]}, "density": 5, "position": [0.247, 0.2]}]})";
    const RunReport report = ran(text, {});
    CHECK(report.bodies.at(0).velocity.norm() < 1.5);
    CHECK(report.bodies.at(0).position.x() < 0.26);
    CHECK(report.bodies.at(0).position.x() > 0.2);
}

TEST_CASE("a vessel starts at rest with the water that is poured into her", "[scene][run]")
{
    const TemporaryDirectory directory("flotsam_test_vessel_cargo");
    const double exact = (3.0 + 0.26 * 0.16 * 40.0) / 60.0;
    // 0.04 m in her, above the pool, or where its water would be without her, which stays outside all the same.
    const std::vector<std::pair<double, std::string>> cases{{0.4, "[0.27,0.22,0.36],\"max\":[0.53,0.38,0.4]"},
                                                            {0.12, "[0.27,0.22,0.08],\"max\":[0.53,0.38,0.12]"}};
    for (const auto& [height, cargo] : cases) {
        const RunReport report =
            ran(tub_text(directory, height, "at_rest"),
                {R"(fluids.0.blocks=[{"min":[0,0,0],"max":[0.8,0.6,0.16]},{"min":)" + cargo + "}]"});
        CHECK(report.bodies.at(0).exact_draft.value() == Approx(exact).epsilon(0.02)); // whole particles
        CHECK(report.bodies.at(0).draft.value() == Approx(exact).margin(0.005));
    }
}

TEST_CASE("notes call bodies and walls by their names", "[scene][run]")
{
    const RunReport report = ran(kCrate, {"bodies.0.shape.box=[0.3,0.04,0.04]", "bodies.0.position=[0.5,0.5,0.8]"});
    REQUIRE(report.notes.size() == 1);
    CHECK(report.notes[0].find("bodies[0] (\"crate\") is thinner") == 0);
}

TEST_CASE("a body that something else holds is noted, and its exact draft is without that", "[scene][run]")
{
    const auto noted = [](const RunReport& report) {
        return std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& note) {
            return note.find("was not afloat on its own: over the last quarter of the run contacts, joints or locks "
                             "pressed it down with") != std::string::npos;
        });
    };
    CHECK_FALSE(noted(ran(kCrate, {})));
    const RunReport held = ran(kCrate, {R"(bodies.0.lock=["z"])", "bodies.0.position=[0.5,0.5,0.25]"}); // under water
    CHECK(noted(held));
    CHECK(held.bodies.at(0).exact_draft.has_value());
    CHECK_FALSE(noted(ran(kCrate, {R"(bodies.0.motion="fixed")", "bodies.0.position=[0.5,0.5,0.25]"})));
}
