#include "support/catch.hpp"

#include "geometry/sheet.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace flotsam;
namespace meshes = test_meshes;
using Solid = SurfaceSampleSettings::Solid;

namespace {

constexpr double kD = 0.1; ///< spacing of samples and particles [m]

SheetSides sides_of(const TriangleMesh& mesh, Solid solid = Solid::inside)
{
    return sheet_sides(SurfaceQuery(mesh), {.spacing = kD, .inset = 0.66 * kD, .solid = solid});
}

/// A pipe along z.
TriangleMesh pipe(double outer, double inner, double half, int corners)
{
    TriangleMesh mesh;
    for (const double radius : {outer, inner})
        for (const double z : {-half, half})
            for (int k = 0; k < corners; ++k) {
                const double angle = 2.0 * std::numbers::pi * k / corners;
                mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
            }
    const auto add = [&](int a, int b, int c, int d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (int k = 0; k < corners; ++k) {
        const int n = (k + 1) % corners, low = 0, high = corners, in_low = 2 * corners, in_high = 3 * corners;
        add(low + k, low + n, high + n, high + k);
        add(in_low + n, in_low + k, in_high + k, in_high + n);
        add(high + k, high + n, in_high + n, in_high + k);
        add(in_low + k, in_low + n, low + n, low + k);
    }
    return mesh;
}

/// A cup about z, its wall and its rim rounded by half its thickness, the bottom flat.
TriangleMesh cup(double radius, double height, double thick, int corners)
{
    std::vector<Eigen::Vector2d> profile = {{radius, 0.0}}; // radius and height, from the outer edge of the bottom
    for (int k = 1; k <= 20; ++k) profile.emplace_back(radius, height * k / 20.0);
    for (int k = 1; k < 12; ++k) {
        const double angle = std::numbers::pi * k / 12.0;
        profile.emplace_back(radius - 0.5 * thick + 0.5 * thick * std::cos(angle),
                             height + 0.5 * thick * std::sin(angle));
    }
    for (int k = 20; k >= 0; --k) profile.emplace_back(radius - thick, thick + (height - thick) * k / 20.0);
    TriangleMesh mesh;
    const int rings = static_cast<int>(profile.size());
    for (const auto& p : profile)
        for (int k = 0; k < corners; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / corners;
            mesh.vertices.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
        }
    const int below = static_cast<int>(mesh.vertices.size()), above = below + 1;
    mesh.vertices.emplace_back(0, 0, 0);
    mesh.vertices.emplace_back(0, 0, thick);
    for (int k = 0; k < corners; ++k) {
        const int n = (k + 1) % corners;
        for (int r = 0; r + 1 < rings; ++r) {
            const int a = r * corners, b = a + corners;
            mesh.triangles.push_back({a + k, a + n, b + n});
            mesh.triangles.push_back({a + k, b + n, b + k});
        }
        mesh.triangles.push_back({below, n, k});
        mesh.triangles.push_back({above, (rings - 1) * corners + k, (rings - 1) * corners + n});
    }
    return mesh;
}

} // namespace

TEST_CASE("a rounded rim parts the sides, too", "[geometry][sheet]")
{
    const double thick = GENERATE(0.3, 0.8) * kD;
    const TriangleMesh mesh = cup(0.5, 1.0, thick, 60);
    REQUIRE(meshes::volume(mesh) > 0.0);
    const SheetSides sides = sides_of(mesh);
    CHECK(sides.sides.size() == 2);
    CHECK(sides.thickness == Approx(thick).epsilon(0.05));
}

TEST_CASE("shells and plates have sides, solids have none", "[geometry][sheet]")
{
    const SheetSides boat = sides_of(meshes::open_shell({-1, -1, 0}, {1, 1, 1}, 0.5 * kD));
    REQUIRE(boat.sides.size() == 2);
    CHECK(boat.sides[0].triangles.size() == 10);
    CHECK(boat.sides[1].triangles.size() == 10);
    CHECK(boat.thickness == Approx(0.5 * kD).epsilon(0.02));

    const SheetSides plate = sides_of(meshes::box({-1, -1, 0}, {1, 1, 0.3 * kD}));
    REQUIRE(plate.sides.size() == 2);
    CHECK(plate.sides[0].triangles.size() == 2);
    CHECK(sides_of(pipe(0.5, 0.5 - 0.4 * kD, 1.0, 40)).sides.size() == 2);

    CHECK(sides_of(meshes::box({-1, -1, 0}, {1, 1, 1.5 * kD})).sides.empty());       // too thick
    CHECK(sides_of(meshes::box({-1, 0, 0}, {1, 0.5 * kD, 0.5 * kD})).sides.empty()); // a rod
    CHECK(sides_of(meshes::sphere(1.0, 20)).sides.empty());
    CHECK(sides_of(meshes::prism({{0.0, 0.0}, {20.0 * kD, 0.5 * kD}, {0.0, kD}}, 1.0)).sides.empty()); // a wedge

    const TriangleMesh open = meshes::open_box({0, 0, 0}, {1, 1, 1});
    const SheetSides both = sides_of(open, Solid::both);
    REQUIRE(both.sides.size() == 2);
    CHECK(both.thickness == 0.0);
    CHECK(sides_of(open, Solid::outside).sides.empty()); // a tank
}

TEST_CASE("vertices of a shell that are not shared count as one", "[geometry][sheet]")
{
    const TriangleMesh shared = meshes::open_shell({-1, -1, 0}, {1, 1, 1}, 0.5 * kD);
    TriangleMesh apart;
    for (std::size_t t = 0; t < shared.triangles.size(); ++t) {
        const int first = static_cast<int>(apart.vertices.size());
        for (int k = 0; k < 3; ++k) apart.vertices.push_back(shared.corner(t, k));
        apart.triangles.push_back({first, first + 1, first + 2});
    }
    CHECK(sides_of(apart).sides.size() == 2);
}

TEST_CASE("a point sees the side of a sheet that it is in front of", "[geometry][sheet]")
{
    const bool closed = GENERATE(false, true);
    CAPTURE(closed);
    const Vec3d low(-1, -1, 0), high(1, 1, 1);
    const double thick = closed ? 0.5 * kD : 0.0;
    const Sheet sheet(closed ? sides_of(meshes::open_shell(low, high, thick))
                             : sides_of(meshes::open_box(low, high), Solid::both),
                      kD);
    CHECK(sheet.thickness() == Approx(thick).epsilon(0.02));
    const auto view = [&](double x, double y, double z) { return sheet.view_from({x, y, z}, 3.0 * kD); };
    const int outer = view(0, 0, -0.1).side, inner = view(0, 0, 0.1 + thick).side;
    REQUIRE(outer >= 0);
    REQUIRE(inner >= 0);
    CHECK(outer != inner);
    CHECK_FALSE(view(0, 0, 0.5).is_near());
    CHECK_FALSE(view(3, 0, 0.5).is_near());
    // Along edges and corners, outside and inside.
    for (double s = -1.05; s <= 1.05; s += 0.07) {
        CAPTURE(s);
        CHECK(view(s, -1.06, -0.06).side == outer);
        CHECK(view(1.06, s, 0.02).side == outer);
        CHECK(view(std::clamp(s, -0.85, 0.85), -0.9, 0.1 + thick).side == inner);
        CHECK(view(-0.9, std::clamp(s, -0.85, 0.85), 0.07 + thick).side == inner);
    }
    const SheetView bottom = view(0.3, 0.2, -0.1);
    CHECK((bottom.place - Vec3d(0.3, 0.2, 0)).norm() < 1e-9);
    CHECK((bottom.normal - Vec3d(0, 0, -1)).norm() < 1e-9);
    CHECK(bottom.beyond_rim == 0.0);
    // Around the rim the sheet comes out of sight.
    CHECK(view(1.1, 0, 0.95).beyond_rim == 0.0);
    CHECK(view(1.1, 0, 1.02).beyond_rim > 0.0);
    CHECK(view(1.1, 0, 1.02).beyond_rim < 0.5);
    CHECK(view(1.0, 0, 1.1).beyond_rim == 1.0);
    // A little deep in the solid it is still the face that it came through.
    if (closed) {
        const SheetView deep = view(0.3, 0.2, 0.1 * thick);
        CHECK(deep.side == outer);
        CHECK((deep.normal - Vec3d(0, 0, -1)).norm() < 1e-9);
    }
}

TEST_CASE("at a sharp fold the side is told by all faces there", "[geometry][sheet]")
{
    // Two squares that enclose 20 degrees along the y axis, as seen from beyond the fold.
    TriangleMesh fold;
    const double angle = 20.0 * std::numbers::pi / 180.0;
    fold.vertices = {{0, -1, 0},
                     {0, 1, 0},
                     {1, 1, 0},
                     {1, -1, 0},
                     {std::cos(angle), 1, std::sin(angle)},
                     {std::cos(angle), -1, std::sin(angle)}};
    fold.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 0, 5}, {1, 5, 4}};
    const Sheet sheet(sides_of(fold, Solid::both), kD);
    const int outside = sheet.view_from({0.5, 0, -0.1}, 1.0).side;
    for (double turn = 100.0; turn < 280.0; turn += 10.0) {
        const double a = turn * std::numbers::pi / 180.0 + 0.5 * angle;
        CAPTURE(turn);
        CHECK(sheet.view_from({0.1 * std::cos(a), 0.2, 0.1 * std::sin(a)}, 1.0).side == outside);
    }
    CHECK(sheet.view_from({0.5, 0, 0.05}, 1.0).side != outside);
}

TEST_CASE("faces of a fold and of a gap are on one side, those of a sheet are not", "[geometry][sheet]")
{
    const SheetView up{{0, 0, 0}, {0, 0, 1}, 0}, down{{0.1, 0, 0}, {0, 0, -1}, 1}, along{{0.2, 0, 0}, {0, 0, 1}, 0};
    const SheetView wall{{0.3, 0, 0.2}, {-1, 0, 0}, 0}, ceiling{{0.1, 0, 0.3}, {0, 0, -1}, 2};
    const SheetView behind{{0.1, 0, -0.3}, {0, 0, -1}, 0};
    CHECK(on_one_side(up, along, 1e-3));
    CHECK_FALSE(on_one_side(up, down, 1e-3));
    CHECK(on_one_side(up, wall, 1e-3));
    CHECK(on_one_side(up, ceiling, 1e-3));      // of another side: a gap
    CHECK_FALSE(on_one_side(up, behind, 1e-3)); // round a thin pipe, say
    for (const SheetView& a : {up, down, along, wall, ceiling, behind})
        for (const SheetView& b : {up, down, along, wall, ceiling, behind})
            CHECK(on_one_side(a, b, 1e-3) == on_one_side(b, a, 1e-3));
}
