#include "flotsam/geometry/shapes.hpp"
#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"
#include "unit/geometry/sample_meshes.hpp"
#include "world/boundary_calibration.hpp"
#include "world/sheet_screen.hpp"

#include <algorithm>
#include <cmath>

using namespace flotsam;
using namespace flotsam::test;
namespace meshes = test_meshes;

namespace {

constexpr double kD = 0.02; ///< particle spacing [m]

FluidWorldSettings settings_of(int dimensions)
{
    FluidWorldSettings s;
    s.dimensions = dimensions;
    s.particle_spacing = kD;
    s.threads = 2;
    return s;
}

/// A square across x at `place`, facing +x.
TriangleMesh square(const Vec3d& place, double half)
{
    TriangleMesh mesh;
    mesh.vertices = {place + Vec3d(0, -half, -half), place + Vec3d(0, half, -half), place + Vec3d(0, half, half),
                     place + Vec3d(0, -half, half)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Vec4 in_floats(const Vec3d& v, double w)
{
    Vec4 result;
    result << v.cast<Scalar>(), static_cast<Scalar>(w);
    return result;
}

struct Neighbourhood {
    SelfPairs fluid;
    Pairs boundary;
};

Neighbourhood pairs_of(const Kernel& kernel, const std::vector<Vec4>& points, const BoundaryState& boundary)
{
    const Workers workers(2);
    const CellGrid grid = CellGrid::around(points, boundary.position, static_cast<double>(kernel.support()), 1u << 20);
    CellLists fluid_cells, boundary_cells;
    fluid_cells.build(grid, points, workers);
    boundary_cells.build(grid, boundary.position, workers);
    Neighbourhood result;
    NeighbourSearch search;
    kernel.visit([&](const auto& spline) {
        search.find(spline, grid, fluid_cells, points, workers, result.fluid);
        search.find(spline, grid, boundary_cells, points, false, boundary.volume, workers, result.boundary);
    });
    return result;
}

/// A lattice around the plane x = 0, half a spacing off it, shaken a little.
std::vector<Vec4> lattice(int first, int last)
{
    std::vector<Vec4> points;
    for (int i = first; i < last; ++i)
        for (int j = -4; j < 4; ++j)
            for (int k = -4; k < 4; ++k) {
                const double shake = 0.1 * std::sin(12.9 * i + 78.2 * j + 37.7 * k);
                points.push_back(in_floats(kD * Vec3d(i + 0.5 + shake, j + 0.5 - shake, k + 0.5 + shake), 0.0));
            }
    return points;
}

BoundaryState samples_of(const SurfaceSamples& samples)
{
    BoundaryState boundary;
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        boundary.position.push_back(in_floats(samples.positions[b], 0.0));
        boundary.volume.push_back(static_cast<Scalar>(kD * kD * kD));
        boundary.owner.push_back(0);
        boundary.normal.push_back(in_floats(samples.normal[b], samples.depth[b]));
        boundary.normal_body.push_back(in_floats(samples.normal[b], samples.side[b]));
    }
    return boundary;
}

double highest_density(const FluidWorld& world)
{
    double highest = 0.0;
    for (const Scalar density : world.fluid().density) highest = std::max(highest, static_cast<double>(density));
    return highest;
}

} // namespace

TEST_CASE("water in front of a sheet feels nothing of what is behind it", "[world][sheet]")
{
    const KernelKind kind = GENERATE(KernelKind::quintic, KernelKind::cubic);
    const Kernel kernel(kind, kD, 3);
    const SurfaceQuery surface(square(Vec3d::Zero(), 12.0 * kD)); // its rim is out of reach
    const SurfaceSampleSettings sampling{
        .spacing = 0.7 * kD, .inset = 0.66 * kD, .solid = SurfaceSampleSettings::Solid::both};
    const SurfaceSamples samples = sample_surface(surface, sampling);
    const Sheet sheet(sheet_sides(surface, sampling), kD);
    const BoundaryState boundary = samples_of(samples);
    SurfaceSamples right_side;
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        if (!(samples.normal[b].x() > 0.0)) continue;
        right_side.positions.push_back(samples.positions[b]);
        right_side.depth.push_back(samples.depth[b]);
        right_side.normal.push_back(samples.normal[b]);
        right_side.side.push_back(samples.side[b]);
    }
    const std::vector<Vec4> right = lattice(0, 4), left = lattice(-4, 0);
    std::vector<Vec4> all = right;
    all.insert(all.end(), left.begin(), left.end());

    Neighbourhood found = pairs_of(kernel, all, boundary);
    const Neighbourhood alone = pairs_of(kernel, right, samples_of(right_side));
    const Neighbourhood before = found;
    SheetScreen screen;
    screen.hide({0, sheet, Pose{}, rim_weight(0.0, kind, kD, 3)}, kernel, all, boundary, Workers(2), found.fluid,
                found.boundary);
    CHECK(found.fluid.kernel_sum[0] < Scalar(0.9) * before.fluid.kernel_sum[0]);
    const double scale = static_cast<double>(kernel.value(0));
    for (std::size_t i = 0; i < right.size(); ++i) {
        CHECK(std::abs(static_cast<double>(found.fluid.kernel_sum[i] - alone.fluid.kernel_sum[i])) < 1e-5 * scale);
        CHECK(static_cast<double>(found.boundary.kernel_sum[i]) ==
              Approx(static_cast<double>(alone.boundary.kernel_sum[i])).margin(1e-5));
        for (std::uint32_t k = found.fluid.start[i]; k < found.fluid.start[i + 1]; ++k) {
            const bool is_hidden = found.fluid.neighbour(i, k) >= right.size();
            CHECK(found.fluid.slope(k) == (is_hidden ? Scalar(0) : before.fluid.slope(k)));
        }
    }
}

TEST_CASE("beyond the rim of a sheet pairs are symmetric and the sheet without thickness is not felt", "[world][sheet]")
{
    const Kernel kernel(KernelKind::quintic, kD, 3);
    const SurfaceQuery surface(square(Vec3d(0, 0, -12.0 * kD), 12.0 * kD)); // its upper rim is at z = 0
    const SurfaceSampleSettings sampling{
        .spacing = 0.7 * kD, .inset = 0.66 * kD, .solid = SurfaceSampleSettings::Solid::both};
    const Sheet sheet(sheet_sides(surface, sampling), kD);
    const BoundaryState boundary = samples_of(sample_surface(surface, sampling));
    const std::vector<Vec4> points = lattice(-4, 4);
    Neighbourhood found = pairs_of(kernel, points, boundary);
    const Neighbourhood before = found;
    SheetScreen screen;
    screen.hide({0, sheet, Pose{}, rim_weight(0.0, KernelKind::quintic, kD, 3)}, kernel, points, boundary, Workers(1),
                found.fluid, found.boundary);
    std::size_t partly = 0, above = 0;
    const auto slope = [&](std::size_t i, std::size_t j) {
        for (std::uint32_t k = found.fluid.start[i]; k < found.fluid.start[i + 1]; ++k)
            if (found.fluid.neighbour(i, k) == j) return found.fluid.slope(k);
        return Scalar(1);
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        double sum = 0.0;
        for (std::uint32_t k = found.fluid.start[i]; k < found.fluid.start[i + 1]; ++k) {
            const std::uint32_t j = found.fluid.neighbour(i, k);
            if (before.fluid.slope(k) == 0) continue; // at the end of the kernel's reach
            const double share = static_cast<double>(found.fluid.slope(k) / before.fluid.slope(k));
            CHECK(slope(j, i) == found.fluid.slope(k));
            partly += share > 0.01 && share < 0.99 ? 1 : 0;
            const double r = static_cast<double>((points[i] - points[j]).norm());
            sum += share * static_cast<double>(kernel.value(static_cast<Scalar>(r)));
        }
        CHECK(static_cast<double>(found.fluid.kernel_sum[i]) == Approx(sum).epsilon(1e-4));
        if (!(points[i].z() > Scalar(0.7 * kD))) continue;
        ++above;
        CHECK(static_cast<double>(found.boundary.kernel_sum[i]) == Approx(0.0).margin(1e-4));
        CHECK(found.fluid.kernel_sum[i] == before.fluid.kernel_sum[i]);
    }
    CHECK(partly > 20);
    CHECK(above > 100);
}

TEST_CASE("a sheet holds deep water that is on one side of it only", "[world][sheet]")
{
    const int dimensions = GENERATE(2, 3);
    const double width = dimensions == 2 ? 0.2 : 0.12, depth = 0.4; // 20 layers
    CAPTURE(dimensions);
    FluidWorld world(settings_of(dimensions));
    world.add_box_wall({Vec3d(0, 0, 0), Vec3d(2.0 * width, width, 0.6)}, {"+z"});
    world.add_wall(square(Vec3d(width, 0.5 * width, 0.3), 0.5), WallSide::both);
    world.add_block({Vec3d(0, 0, 0), Vec3d(width, width, depth)});
    FreeBodies none({}, Vec3d(0, 0, -9.81));
    const std::size_t all = [&] {
        world.prepare(none);
        return world.fluid().size();
    }();
    REQUIRE(all > (dimensions == 2 ? 190u : 700u));
    int leaked = 0;
    while (world.time() < 1.0) leaked += world.step(world.allowed_time_step(), none).leaked;
    CHECK(leaked == 0);
    for (const Vec4& p : world.fluid().position) CHECK(static_cast<double>(p.x()) < width);
    CHECK(highest_density(world) < 1020.0);
    CHECK(world.level_at(0.5 * width, 0.5 * width).value() == Approx(depth).margin(0.35 * kD));
}

TEST_CASE("a boat of sheet metal floats dry at the draft of its mass", "[world][sheet]")
{
    // 15 spacings wide and 8 high; of 0, a quarter and one spacing of thickness.
    const double thick = kD * GENERATE(0.1, 0.25, 1.0), draft = 0.08;
    CAPTURE(thick);
    FluidWorld world(settings_of(2));
    world.add_box_wall({Vec3d(0, -1, 0), Vec3d(0.8, 1, 0.6)}, {"+z"});
    world.add_block({Vec3d(0, -1, 0), Vec3d(0.8, 1, 0.3)});
    const TriangleMesh hull = meshes::open_shell(Vec3d(-0.15, -1, -0.04), Vec3d(0.15, 1, 0.12), thick);
    world.add_body(hull);
    FreeBody boat = free_box(Vec3d(0.3, 1.0, 0.16), 1000.0 * draft / 0.16, Vec3d(0.4, 0, 0.34));
    FreeBodies bodies({boat}, Vec3d(0, 0, -9.81));
    double mean = 0.0;
    int steps = 0, inside = 0;
    while (world.time() < 4.0) {
        const StepReport report = world.step(world.allowed_time_step(), bodies);
        CHECK(report.leaked == 0);
        if (world.time() < 3.0) continue;
        const Pose& pose = bodies.bodies[0].pose;
        mean += world.level_at(0.05, 0).value() - (pose.position.z() - 0.04);
        ++steps;
        for (const Vec4& p : world.fluid().position) {
            const Vec3d at = pose.to_body(p.head<3>().cast<double>());
            inside += std::abs(at.x()) < 0.15 - thick && at.z() > -0.04 + thick && at.z() < 0.1 ? 1 : 0;
        }
    }
    REQUIRE(steps > 100);
    CHECK(inside == 0);
    // Within a quarter of a spacing, as other bodies.
    CHECK(mean / steps == Approx(draft).margin(0.25 * kD));
    CHECK(highest_density(world) < 1050.0);
}

TEST_CASE("with sheets, too, sums do not depend on the number of threads, and momentum is kept", "[world][sheet]")
{
    std::uint64_t hash = 0;
    for (const int threads : {1, 2, 3}) {
        FluidWorldSettings settings = settings_of(3);
        settings.threads = threads;
        FluidWorld world(settings);
        world.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.5)}, {"+z"});
        world.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.2)});
        const Vec3d half(0.1, 0.1, 0.003);
        world.add_body(tessellate(BoxShape{2.0 * half}, kD));
        FreeBodies bodies({free_box(2.0 * half, 3000.0, Vec3d(0.2, 0.2, 0.1))}, Vec3d(0, 0, -9.81));
        Vec3d to_body = Vec3d::Zero();
        for (int k = 0; k < 20; ++k) to_body += world.step(0.002, bodies).body_impulse;
        const FreeBody& plate = bodies.bodies[0];
        const Vec3d gained = plate.momentum - plate.mass * Vec3d(0, 0, -9.81 * 20 * 0.002);
        CHECK(to_body.z() > 0.05 * plate.mass * 9.81 * 20 * 0.002); // the water held it up
        CHECK((gained - to_body).norm() < 1e-9 * to_body.norm());
        if (threads == 1) hash = world.state_hash();
        CHECK(world.state_hash() == hash);
    }
}

TEST_CASE("water around a vessel does not fill her, water that is put into her stays", "[world][vessel]")
{
    // 10 x 10 x 8 spacings of a vessel; 4 spacings of draft, or wholly under water, or water put into her.
    const int way = GENERATE(0, 1, 2);
    CAPTURE(way);
    const Vec3d half(0.1, 0.1, 0.08);
    FluidWorld world(settings_of(3));
    world.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, 0.5)}, {"+z"});
    const double bottom = way == 0 ? 0.12 : way == 1 ? 0.02 : 0.25, level = 0.2;
    world.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.4, level)});
    if (way == 2) world.add_block({Vec3d(0.12, 0.12, bottom + 0.02), Vec3d(0.28, 0.28, bottom + 0.1)});
    world.name_body(world.add_body(meshes::open_shell(-half, half, 0.01)), "the tub");
    FreeBodies bodies({free_box(2.0 * half, 500.0, Vec3d(0.2, 0.2, bottom + half.z()))}, Vec3d(0, 0, -9.81));
    world.prepare(bodies);
    int inside = 0;
    for (const Vec4& p : world.fluid().position) {
        const Vec3d at = p.head<3>().cast<double>() - Vec3d(0.2, 0.2, bottom);
        inside += at.head<2>().cwiseAbs().maxCoeff() < 0.092 && at.z() > 0.008 && at.z() < 0.16 ? 1 : 0;
    }
    const bool is_noted = std::any_of(world.notes().begin(), world.notes().end(),
                                      [](const std::string& note) { return note.rfind("the tub starts dry", 0) == 0; });
    CHECK(is_noted == (way == 0));
    if (way == 0)
        CHECK(inside == 0);
    else
        CHECK(inside > (way == 1 ? 400 : 200));
}
