#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/box_mesh.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.02, kHigh = 0.36, kLow = 0.2;

FluidWorldSettings settings(int dimensions)
{
    FluidWorldSettings s;
    s.dimensions = dimensions;
    s.particle_spacing = kSpacing;
    s.threads = 1;
    return s;
}

/// The water's surface is that of a lattice of particles.
auto is_level_of(double level)
{
    return Approx(level).margin(0.5 * kSpacing);
}

/// Boxes that are held where they are, floating or not.
struct Floats {
    explicit Floats(FluidWorld& into) : fluid(into) {}

    void add(const Vec3d& edges, const Vec3d& position)
    {
        fluid.add_body(tessellate(BoxShape{edges}, kSpacing));
        bodies.bodies.push_back(free_box(edges, 500.0, position));
    }
    std::vector<std::optional<double>> waterlines()
    {
        fluid.prepare(bodies);
        std::vector<BodyState> states(bodies.size());
        bodies.read(0.0, states);
        all = fluid.waterline(states);
        return fluid.waterlines(states);
    }

    FluidWorld& fluid;
    FreeBodies bodies{{}};
    std::optional<double> all; ///< the water line of all the water
};

enum class Dam { closed_mesh, sheet, body };

/// A tank from x = 0 to 1.4 with a dam from 0.5 to 0.6 (a sheet: at 0.5): water is higher before it, but there is less
/// of it.
void fill_basins(FluidWorld& fluid, Floats& floats, Dam dam, double width)
{
    const double end = dam == Dam::sheet ? 0.5 : 0.6;
    const double y = fluid.settings().dimensions == 2 ? 0.1 : width;
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(1.4, y, 0.6)}, {"+z"});
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(0.5, y, kHigh)});
    fluid.add_block({Vec3d(end, 0, 0), Vec3d(1.4, y, kLow)});
    if (dam == Dam::closed_mesh) fluid.add_wall(box_mesh({Vec3d(0.5, -1, -0.1), Vec3d(end, 1, 0.5)}));
    if (dam == Dam::body) floats.add(Vec3d(0.1, width, 0.5), Vec3d(0.55, 0.5 * y, 0.25));
    if (dam != Dam::sheet) return;
    TriangleMesh sheet;
    sheet.vertices = {Vec3d(0.5, -1, -0.1), Vec3d(0.5, 1, -0.1), Vec3d(0.5, 1, 0.5), Vec3d(0.5, -1, 0.5)};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    fluid.add_wall(sheet, WallSide::both);
}

} // namespace

TEST_CASE("in two basins each body has the level of its own", "[world][waterline]")
{
    // The report's one water line was that of the larger basin, whatever body it stood beside.
    const Dam dam = GENERATE(Dam::closed_mesh, Dam::sheet, Dam::body);
    FluidWorld fluid(settings(2));
    Floats floats(fluid);
    fill_basins(fluid, floats, dam, 1.0);
    const std::size_t first = floats.bodies.size();
    const Vec3d edges(0.1, 1.0, 0.1);
    floats.add(edges, Vec3d(0.25, 0, kHigh));       // afloat
    floats.add(edges, Vec3d(1.0, 0, kLow));         // afloat
    floats.add(edges, Vec3d(0.11, 0, 0.11));        // sunk
    floats.add(edges, Vec3d(1.2, 0, kLow + 0.2));   // above its water
    floats.add(edges, Vec3d(0.44, 0, kHigh + 0.1)); // above its water, and close to the dam
    const auto levels = floats.waterlines();
    CAPTURE(static_cast<int>(dam));
    REQUIRE(levels.size() == first + 5);
    for (const std::size_t k : {0, 2, 4}) CHECK(levels[first + k].value() == is_level_of(kHigh));
    for (const std::size_t k : {1, 3}) CHECK(levels[first + k].value() == is_level_of(kLow));
}

TEST_CASE("in two basins in three dimensions each body has the level of its own", "[world][waterline]")
{
    const Dam dam = GENERATE(Dam::closed_mesh, Dam::sheet);
    FluidWorld fluid(settings(3));
    Floats floats(fluid);
    fill_basins(fluid, floats, dam, 0.3);
    floats.add(Vec3d::Constant(0.1), Vec3d(0.25, 0.15, kHigh));
    floats.add(Vec3d::Constant(0.1), Vec3d(1.0, 0.15, kLow));
    const auto levels = floats.waterlines();
    CAPTURE(static_cast<int>(dam));
    CHECK(levels.at(0).value() == is_level_of(kHigh));
    CHECK(levels.at(1).value() == is_level_of(kLow));
}

TEST_CASE("water that runs over a dam does not make two basins one", "[world][waterline]")
{
    FluidWorld fluid(settings(2));
    Floats floats(fluid);
    const double crest = 0.28;
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(1.4, 0.1, 0.6)}, {"+z"});
    fluid.add_wall(box_mesh({Vec3d(0.5, -1, -0.1), Vec3d(0.6, 1, crest)}));
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(0.5, 0.1, kHigh)});
    fluid.add_block({Vec3d(0.5, 0, crest), Vec3d(0.6, 0.1, kHigh)});
    fluid.add_block({Vec3d(0.6, 0, kLow), Vec3d(0.66, 0.1, kHigh)}); // falls
    fluid.add_block({Vec3d(0.6, 0, 0), Vec3d(1.4, 0.1, kLow)});
    floats.add(Vec3d(0.1, 1.0, 0.1), Vec3d(0.25, 0, kHigh));
    floats.add(Vec3d(0.1, 1.0, 0.1), Vec3d(1.0, 0, kLow));
    const auto levels = floats.waterlines();
    CHECK(levels.at(0).value() == is_level_of(kHigh));
    CHECK(levels.at(1).value() == is_level_of(kLow));
}

TEST_CASE("what lies under the ceiling of a covered arm is no surface", "[world][waterline]")
{
    // An L that lies on its side: the long arm is full up to its ceiling, the water stands in the short one.
    TriangleMesh tank;
    const std::array<std::array<double, 2>, 6> outline{
        {{0, 0}, {1.4, 0}, {1.4, 0.2}, {0.4, 0.2}, {0.4, 0.6}, {0, 0.6}}};
    for (const double y : {-0.5, 0.5})
        for (const auto& [x, z] : outline) tank.vertices.emplace_back(x, y, z);
    for (int k = 0; k < 6; ++k) {
        const int next = (k + 1) % 6;
        tank.triangles.push_back({k, next, next + 6});
        tank.triangles.push_back({k, next + 6, k + 6});
    }
    for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
        tank.triangles.push_back({a, c, b});
        tank.triangles.push_back({a + 6, b + 6, c + 6});
    }
    FluidWorld fluid(settings(2));
    Floats floats(fluid);
    fluid.add_wall(tank, WallSide::automatic);
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(1.4, 0.1, 0.2)});
    fluid.add_block({Vec3d(0, 0, 0.2), Vec3d(0.4, 0.1, kHigh)});
    floats.add(Vec3d(0.1, 1.0, 0.1), Vec3d(0.2, 0, kHigh));
    floats.add(Vec3d(0.1, 1.0, 0.1), Vec3d(1.0, 0, 0.1));
    const auto levels = floats.waterlines();
    for (const auto& level : levels) CHECK(level.value() == is_level_of(kHigh));
}

TEST_CASE("in the arms of an L-shaped tank with a dam each body has the level of its own", "[world][waterline]")
{
    // Seen from above: one arm along x, one along y, and a dam across the second.
    FluidWorld fluid(settings(3));
    Floats floats(fluid);
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(1.0, 0.9, 0.6)}, {"+z"});
    fluid.add_wall(box_mesh({Vec3d(0.3, 0.3, -0.1), Vec3d(1.1, 1.0, 0.7)})); // what the L goes around
    fluid.add_wall(box_mesh({Vec3d(-0.1, 0.4, -0.1), Vec3d(0.3, 0.5, 0.5)}));
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(1.0, 0.3, kLow)});
    fluid.add_block({Vec3d(0, 0.3, 0), Vec3d(0.3, 0.4, kLow)});
    fluid.add_block({Vec3d(0, 0.5, 0), Vec3d(0.3, 0.9, kHigh)});
    floats.add(Vec3d::Constant(0.1), Vec3d(0.8, 0.15, kLow));
    floats.add(Vec3d::Constant(0.1), Vec3d(0.15, 0.7, kHigh));
    const auto levels = floats.waterlines();
    CHECK(levels.at(0).value() == is_level_of(kLow));
    CHECK(levels.at(1).value() == is_level_of(kHigh));
}

TEST_CASE("in one basin a body's water line is that of all the water", "[world][waterline]")
{
    // To the last digit: with waves, beside a body from wall to wall nearly, and where bodies cover the whole tank.
    const auto edges = GENERATE(Vec3d(0.1, 1.0, 0.1), Vec3d(0.3, 1.0, 0.1), Vec3d(0.36, 1.0, 0.1));
    FluidWorld fluid(settings(2));
    Floats floats(fluid);
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.4, 0.1, 0.6)}, {"+z"});
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.1, 0.3)}, Vec3d(0.8, 0, 0));
    floats.add(edges, Vec3d(0.2, 0, 0.3));
    const auto at_start = floats.waterlines();
    REQUIRE(floats.all);
    CHECK(at_start.at(0).value() == *floats.all);
    if (edges.x() > 0.3) return; // such a piston throws the water about
    std::vector<BodyState> states(1);
    double lowest = 1.0, highest = 0.0;
    while (fluid.time() < 0.2) {
        fluid.step(fluid.allowed_time_step(), floats.bodies);
        floats.bodies.read(0.0, states);
        CHECK(fluid.waterlines(states).at(0).value_or(-1.0) == fluid.waterline(states).value_or(-1.0));
        for (const double x : {0.01, 0.39}) {
            const double level = fluid.level_at(x, 0.0).value_or(0.3);
            lowest = std::min(lowest, level);
            highest = std::max(highest, level);
        }
    }
    CHECK(highest - lowest > 2.0 * kSpacing); // there were waves
}

TEST_CASE("a body's hydrostatic force is that of the water that it is in", "[world][waterline]")
{
    FluidWorld fluid(settings(2));
    Floats floats(fluid);
    fill_basins(fluid, floats, Dam::closed_mesh, 1.0);
    floats.add(Vec3d(0.1, 1.0, 0.1), Vec3d(0.25, 0, kHigh));
    floats.add(Vec3d(0.1, 1.0, 0.1), Vec3d(1.0, 0, kLow));
    (void)floats.waterlines();
    fluid.step(0.0005, floats.bodies);
    // half of each is under water; levels are known to half a spacing
    const double whole = 1000.0 * 9.81 * 0.1 * 0.1;
    for (const int body : {0, 1})
        CHECK(fluid.fluid_forces(body).hydrostatic.linear.z() == Approx(0.5 * whole).margin(0.1 * whole));
}
