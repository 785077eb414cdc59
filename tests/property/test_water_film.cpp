#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"
#include "support/scene_run.hpp"

#include <sstream>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.02;

/// A tank of 18 x 18 spacings, 10 deep, with these bodies.
std::string tank_with(const std::string& bodies, double duration)
{
    std::ostringstream scene;
    scene << R"({"flotsam": 1, "particle_spacing": 0.02, "duration": )" << duration
          << R"(, "fluids": [{"blocks": [{"min": [0, 0, 0], "max": [0.36, 0.36, 0.2]}]}],
        "walls": [{"box": {"min": [0, 0, 0], "max": [0.36, 0.36, 0.6], "open": ["+z"]}}], "bodies": [)"
          << bodies << "]}";
    return scene.str();
}

std::string cube(const std::string& name, double density, const std::string& position)
{
    std::ostringstream body;
    body << R"({"name": ")" << name << R"(", "shape": {"box": [0.12, 0.12, 0.12]}, "density": )" << density
         << R"(, "position": [)" << position << "]}";
    return body.str();
}

/// The weight of the water that a cube displaces, of which nothing is above the water [N].
constexpr double kDisplaced = 1000.0 * 9.81 * 0.12 * 0.12 * 0.12;

} // namespace

TEST_CASE("what is lighter than water comes up from the floor on which it lay flush", "[property]")
{
    const double density = GENERATE(30.0, 500.0, 800.0);
    const std::string position = GENERATE("0.18, 0.18, 0.06", "0.06, 0.06, 0.06"); // in the middle, in a corner
    CAPTURE(density, position);
    const RunReport report = run_text(tank_with(cube("crate", density, position), 0.8));
    CHECK(report.bodies.at(0).position.z() > 0.06 + 2.0 * kSpacing);
    CHECK(report.bodies.at(0).velocity.norm() < 1.5);
}

TEST_CASE("crates that lay flush on each other come up one by one", "[property]")
{
    const RunReport report = run_text(
        tank_with(cube("lower", 800.0, "0.18, 0.18, 0.06") + ", " + cube("upper", 300.0, "0.18, 0.18, 0.18"), 0.8));
    CHECK(report.bodies.at(0).position.z() > 0.06 + 2.0 * kSpacing);
    CHECK(report.bodies.at(1).position.z() > report.bodies.at(0).position.z() + 0.1);
}

TEST_CASE("what lies flush on the floor presses on it with its weight less the water's", "[property]")
{
    const RunReport report = run_text(tank_with(cube("stone", 1800.0, "0.18, 0.18, 0.06"), 0.8));
    CHECK(std::abs(report.bodies.at(0).position.z() - 0.06) < 0.001);
    CHECK(report.bodies.at(0).force_fluid_mean.z() == Approx(kDisplaced).epsilon(0.12));
}

TEST_CASE("round bodies on the floor feel their displaced weight, and come up if they are lighter", "[property]")
{
    constexpr double kRadius = 0.12, kOfDisc = 1000.0 * 9.81 * 3.1415927 * kRadius * kRadius;
    const double density = GENERATE(3000.0, 500.0);
    std::ostringstream scene;
    scene << R"({"flotsam": 1, "dimensions": 2, "particle_spacing": 0.02, "duration": 1.5,
        "fluids": [{"blocks": [{"min": [0, 0], "max": [0.8, 0.6]}]}],
        "walls": [{"box": {"min": [0, 0], "max": [0.8, 1.0], "open": ["+z"]}}],
        "bodies": [{"name": "log", "shape": {"disc": 0.12}, "position": [0.4, 0.12], "density": )"
          << density << "}]}";
    const BodyReport log = run_text(scene.str()).bodies.at(0);
    CAPTURE(density);
    if (density < 1000.0) {
        CHECK(log.position.z() > 0.4);
        return;
    }
    CHECK(std::abs(log.position.z() - kRadius) < 0.002);
    CHECK(log.force_fluid_mean.z() == Approx(kOfDisc).epsilon(0.15)); // a quarter of it without a film in the wedges
}

TEST_CASE("a puddle does not lift what it could not carry", "[property]")
{
    const std::string scene = R"({"flotsam": 1, "particle_spacing": 0.02, "duration": 0.8,
        "fluids": [{"blocks": [{"min": [0, 0, 0], "max": [0.36, 0.36, 0.06]}]}],
        "walls": [{"box": {"min": [0, 0, 0], "max": [0.36, 0.36, 0.6], "open": ["+z"]}}],
        "bodies": [{"name": "crate", "shape": {"box": [0.12, 0.12, 0.12]}, "density": 800, "position": [0.18, 0.18, 0.06]}]})";
    const BodyReport crate = run_text(scene).bodies.at(0);
    CHECK(std::abs(crate.position.z() - 0.06) < 0.001);
    CHECK(crate.force_fluid_mean.z() == Approx(0.5 * kDisplaced).epsilon(0.25)); // half of it is in the water
}

TEST_CASE("the film under a body is in the pressures on its triangles, and in the balances", "[property]")
{
    FluidWorldSettings settings;
    settings.particle_spacing = kSpacing;
    FluidWorld water(settings);
    water.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.36, 0.36, 0.6)}, {"+z"});
    water.add_block({Vec3d(0, 0, 0), Vec3d(0.36, 0.36, 0.2)});
    const Vec3d edges(0.12, 0.12, 0.12);
    const TriangleMesh mesh = tessellate(BoxShape{edges}, kSpacing);
    water.add_body(mesh);
    FreeBodies bodies({free_box(edges, 1e9, Vec3d(0.18, 0.18, 0.06))}); // too heavy to move, without gravity of its own
    Ledger sum;
    while (water.time() < 0.3) sum += water.step(std::min(0.004, water.allowed_time_step()), bodies).ledger;
    const Vec3d pressed = water.fluid_forces(0).pressure().linear;
    CHECK(pressed.z() == Approx(kDisplaced).epsilon(0.15));
    const std::vector<double> pressure = water.surface_pressure(0);
    Vec3d on_triangles = Vec3d::Zero(), on_floor_side = Vec3d::Zero();
    for (std::size_t t = 0; t < pressure.size(); ++t) {
        const Vec3d area = 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
        on_triangles -= pressure[t] * area;
        if (area.z() < -0.9 * area.norm()) on_floor_side -= pressure[t] * area;
    }
    CHECK(on_triangles.z() == Approx(pressed.z()).epsilon(0.02));
    CHECK(on_floor_side.z() > 0.8 * 1000.0 * 9.81 * 0.2 * 0.12 * 0.12); // there is no particle under it
    CHECK(sum.errors().momentum.norm() < 1e-5 * sum.scales().momentum);
    CHECK(sum.errors().angular_momentum.norm() < 1e-5 * sum.scales().angular_momentum);
}

TEST_CASE("films in a heap of crates do not feed each other", "[property]")
{
    // In one of five such heaps films without a bound of their pressure took forty times as many steps.
    std::ostringstream scene;
    scene << R"({"flotsam": 1, "dimensions": 2, "particle_spacing": 0.02, "duration": 1.6,
        "fluids": [{"blocks": [{"min": [0, 0], "max": [1.0, 0.1]}]}],
        "walls": [{"box": {"min": [0, 0], "max": [1.0, 1.6], "open": ["+z"]}}], "bodies": [)";
    constexpr double kDensities[] = {400, 1500, 2500}, kTurns[] = {-22, 21, 16, -15, 0, -3, 9, -11};
    for (int k = 0; k < 25; ++k) {
        scene << (k > 0 ? ", " : "") << R"({"name": "b)" << k << R"(", "shape": {"box": [0.1, 0.08]}, "density": )"
              << kDensities[k % 3] << R"(, "position": [)" << 0.15 + 0.17 * (k % 5) << ", " << 0.3 + 0.16 * (k / 5)
              << R"(], "rotation_deg": [0, )" << kTurns[k % 8] << ", 0]}";
    }
    scene << "]}";
    const RunReport report = run_text(scene.str());
    CHECK(report.simulated_seconds > 1.59);
    CHECK(report.steps < 1500); // 400 of the largest ones
}
