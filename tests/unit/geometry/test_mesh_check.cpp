#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"

#include <random>

using namespace flotsam;
using Catch::Matchers::Contains;

namespace {

TriangleMesh box_at(const Vec3d& edges, const Vec3d& center)
{
    return transformed(tessellate(BoxShape{edges}, 1.0), {center, Quatd::Identity()});
}

/// As STL has it: every triangle with corners of its own.
TriangleMesh unwelded(const TriangleMesh& mesh)
{
    TriangleMesh soup;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) soup.vertices.push_back(mesh.corner(t, k));
        const auto first = static_cast<int>(3 * t);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

/// A band of n quads with `half_turns`; 1 makes it a Moebius strip.
TriangleMesh band(int n, int half_turns)
{
    TriangleMesh mesh;
    for (int k = 0; k < n; ++k) {
        const double around = 2.0 * 3.14159265358979 * k / n;
        const double twist = 0.5 * half_turns * around;
        const Vec3d radial(std::cos(around), std::sin(around), 0.0);
        const Vec3d across = std::cos(twist) * Vec3d::UnitZ() + std::sin(twist) * radial;
        mesh.vertices.push_back(2.0 * radial - 0.3 * across);
        mesh.vertices.push_back(2.0 * radial + 0.3 * across);
    }
    for (int k = 0; k < n; ++k) {
        const int a = 2 * k;
        int c = 2 * ((k + 1) % n);
        int d = c + 1;
        if (k == n - 1 && half_turns % 2 == 1) std::swap(c, d);
        mesh.triangles.push_back({a, c, d});
        mesh.triangles.push_back({a, d, a + 1});
    }
    return mesh;
}

std::string refusal(TriangleMesh mesh, const MeshCheckOptions& options = {})
{
    try {
        check_mesh(mesh, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "(accepted)";
}

} // namespace

TEST_CASE("a sound mesh passes unchanged and without notes", "[geometry][mesh_check]")
{
    TriangleMesh box = tessellate(BoxShape{{1, 2, 3}}, 1.0);
    const TriangleMesh before = box;
    const MeshCheckReport report = check_mesh(box, {.name = "box.obj", .particle_spacing = 0.1});
    CHECK(report.notes.empty());
    CHECK(report.parts == 1);
    CHECK(report.closed);
    CHECK(report.flipped_triangles + report.dropped_triangles + report.welded_vertices == 0);
    CHECK(box.triangles == before.triangles);
    CHECK(box.vertices == before.vertices);
    CHECK(box.part_of_triangle == std::vector<int>(12, 0));
}

TEST_CASE("a triangle soup is welded", "[geometry][mesh_check]")
{
    TriangleMesh soup = unwelded(tessellate(SphereShape{0.5}, 0.2));
    const std::size_t triangles = soup.triangles.size();
    const MeshCheckReport exact = check_mesh(soup);
    CHECK(exact.notes.empty()); // that is how STL is
    CHECK(soup.triangles.size() == triangles);
    CHECK(soup.vertices.size() == triangles / 2 + 2);
    CHECK(exact.welded_vertices == static_cast<int>(3 * triangles - soup.vertices.size()));

    TriangleMesh noisy = unwelded(tessellate(SphereShape{0.5}, 0.2));
    std::mt19937 random(1);
    std::uniform_real_distribution<double> jitter(-3e-7, 3e-7);
    for (Vec3d& vertex : noisy.vertices) vertex += Vec3d(jitter(random), jitter(random), jitter(random));
    const MeshCheckReport report = check_mesh(noisy, {.name = "ball.stl"});
    REQUIRE(report.notes.size() == 1);
    CHECK_THAT(report.notes[0], Contains("ball.stl: welded ") && Contains("vertices to others up to "));
    CHECK(report.closed);
    CHECK(noisy.vertices.size() == soup.vertices.size());
}

TEST_CASE("triangles that face inward are turned", "[geometry][mesh_check]")
{
    TriangleMesh some = tessellate(BoxShape{}, 1.0);
    for (const std::size_t t : {1, 4, 9}) std::swap(some.triangles[t][0], some.triangles[t][1]);
    const MeshCheckReport report = check_mesh(some, {.name = "hull.stl"});
    CHECK(report.flipped_triangles == 3);
    CHECK(report.notes == std::vector<std::string>{"hull.stl: turned 3 of 12 triangles that faced inward"});
    CHECK(mass_properties(some).volume == Approx(1.0));

    TriangleMesh all = flipped(tessellate(BoxShape{}, 1.0));
    CHECK(check_mesh(all).flipped_triangles == 12);
    CHECK(mass_properties(all).volume == Approx(1.0));
}

TEST_CASE("degenerate and doubled triangles and unused vertices are dropped", "[geometry][mesh_check]")
{
    TriangleMesh box = tessellate(BoxShape{}, 1.0);
    box.triangles.push_back({3, 3, 5});
    box.triangles.push_back(box.triangles[2]);
    box.triangles.push_back({box.triangles[6][1], box.triangles[6][0], box.triangles[6][2]});
    box.vertices.emplace_back(100, 100, 100);
    const MeshCheckReport report = check_mesh(box, {.name = "box"});
    CHECK(report.dropped_triangles == 3);
    CHECK(report.notes == std::vector<std::string>{"box: dropped 3 degenerate or doubled triangles"});
    CHECK(box.triangles.size() == 12);
    CHECK(box.part_of_triangle.size() == 12);
    CHECK(box.vertices.size() == 8);
}

TEST_CASE("a part inside another is a cavity, one inside that is solid again", "[geometry][mesh_check]")
{
    TriangleMesh nested = tessellate(BoxShape{{3, 3, 3}}, 1.0);
    nested.part_names = {"hull"};
    nested = joined(nested, tessellate(BoxShape{{2, 2, 2}}, 1.0));
    nested = joined(nested, tessellate(BoxShape{}, 1.0));
    nested = joined(nested, box_at({1, 1, 1}, {5, 0, 0})); // beside them
    const MeshCheckReport report = check_mesh(nested, {.name = "hull.obj"});
    CHECK(report.parts == 4);
    CHECK(nested.part_names == std::vector<std::string>{"hull", "", "", ""});
    CHECK(report.flipped_triangles == 12);
    CHECK(mass_properties(nested).volume == Approx(27.0 - 8.0 + 1.0 + 1.0));
    REQUIRE(report.notes.size() == 2);
    CHECK_THAT(report.notes[1], Contains("1 part lies inside another part and is taken for a cavity"));
}

TEST_CASE("a solid in parts by material is one part after the check", "[geometry][mesh_check]")
{
    TriangleMesh box = unwelded(tessellate(BoxShape{}, 1.0));
    box.part_of_triangle.assign(12, 0);
    std::fill(box.part_of_triangle.begin() + 6, box.part_of_triangle.end(), 1);
    box.part_names = {"wood", "steel"};
    const MeshCheckReport report = check_mesh(box);
    CHECK(report.parts == 1);
    CHECK(box.part_names == std::vector<std::string>{"wood"});
    CHECK(report.closed);
}

TEST_CASE("parts may touch", "[geometry][mesh_check]")
{
    const Vec3d offset = GENERATE(Vec3d(1, 0, 0), Vec3d(1, 0.25, 0.125), Vec3d(1, 1, 0), Vec3d(1, 1, 1));
    TriangleMesh two = joined(tessellate(BoxShape{}, 1.0), box_at({1, 1, 1}, offset));
    const MeshCheckReport report = check_mesh(two);
    CHECK(report.parts == 2);
    CHECK(report.notes.empty());
    CHECK(mass_properties(two).volume == Approx(2.0));
}

TEST_CASE("parts that cut each other are refused", "[geometry][mesh_check]")
{
    const Vec3d offset =
        GENERATE(Vec3d(0.3, 0.2, 0.1), Vec3d(0.5, 0, 0), Vec3d(0.5, 0.5, 0), Vec3d(0, 0, 0), Vec3d(0.9999, 0.3, 0.4));
    const TriangleMesh two = joined(tessellate(BoxShape{}, 1.0), box_at({1, 1, 1}, offset));
    CHECK_THAT(refusal(two, {.name = "two.obj"}), Contains("two.obj has parts that cut each other at (") &&
                                                      Contains("parts may touch or lie inside each other"));
    // Grids that lie on each other, where no edge goes through any triangle.
    const TriangleMesh aligned =
        joined(refined(tessellate(BoxShape{{2, 2, 2}}, 1.0), 0.8), refined(box_at({2, 2, 2}, {1, 1, 1}), 0.8));
    CHECK_THAT(refusal(aligned), Contains("cut each other"));
    // A bar through a box: no vertex of either lies inside the other.
    CHECK_THAT(refusal(joined(tessellate(BoxShape{}, 1.0), box_at({0.1, 0.2, 5}, {0.1, 0.05, 0}))),
               Contains("cut each other"));
}

TEST_CASE("a surface that cuts itself is noted", "[geometry][mesh_check]")
{
    TriangleMesh box = refined(tessellate(BoxShape{}, 1.0), 0.3);
    for (Vec3d& v : box.vertices)
        if (v.z() > 0.49 && std::abs(v.x()) < 0.1 && std::abs(v.y()) < 0.1) v.z() = -0.7; // pushed through the floor
    const MeshCheckReport report = check_mesh(box, {.name = "dent"});
    REQUIRE(report.notes.size() == 1);
    CHECK_THAT(report.notes[0], Contains("dent: its surface cuts itself at ("));
}

TEST_CASE("a mesh without usable triangles or vertices is refused", "[geometry][mesh_check]")
{
    CHECK(refusal({}) == "mesh has no triangles, at least one is needed");
    TriangleMesh flat;
    flat.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    flat.triangles = {{0, 1, 2}, {0, 0, 0}};
    CHECK_THAT(refusal(flat), Contains("has only triangles without area"));

    TriangleMesh box = tessellate(BoxShape{}, 1.0);
    box.triangles[7][1] = 8;
    CHECK(refusal(box, {.name = "box.ply"}) == "box.ply has no vertex 8, which triangle 7 names; allowed are 0 to 7");
}

TEST_CASE("coordinates that are not finite are refused with their vertex", "[geometry][mesh_check]")
{
    const double bad = GENERATE(std::nan(""), 1.0 / 0.0, 1e30);
    TriangleMesh box = tessellate(BoxShape{}, 1.0);
    box.vertices[3].y() = bad;
    CHECK_THAT(refusal(box, {.name = "box.obj"}), Contains("box.obj has vertex 3 at (-0.5, ") &&
                                                      Contains("; coordinates must be finite and within 1e9 m"));
}

TEST_CASE("an open mesh is refused as a solid, with the first open edge", "[geometry][mesh_check]")
{
    const TriangleMesh open = container_box({{0, 0, 0}, {1, 2, 3}}, {"+z"});
    const std::string sentence = refusal(open, {.name = "tank.stl"});
    CHECK_THAT(sentence, Contains("tank.stl has 4 edges with a triangle on one side only, the first from (") &&
                             Contains(", 3)") && Contains("the surface of a solid must be closed"));
}

TEST_CASE("an edge of three triangles is refused in a solid", "[geometry][mesh_check]")
{
    TriangleMesh box = tessellate(BoxShape{}, 1.0);
    box.vertices.emplace_back(3, 0, 0);
    box.triangles.push_back({box.triangles[0][0], box.triangles[0][1], 8});
    CHECK_THAT(refusal(box), Contains("has 1 edge shared by more than two triangles, the first from (-0.5, -0.5, "));
}

TEST_CASE("a Moebius strip is refused, a band is a fine wall", "[geometry][mesh_check]")
{
    CHECK_THAT(refusal(band(24, 1), {.name = "strip", .must_be_closed = false}),
               Contains("strip is not orientable: at the edge from ("));
    TriangleMesh untwisted = band(24, 0);
    CHECK_FALSE(check_mesh(untwisted, {.must_be_closed = false}).closed);
    TriangleMesh turned_twice = band(24, 2);
    CHECK(check_mesh(turned_twice, {.must_be_closed = false}).parts == 1);
}

TEST_CASE("an open wall keeps the side that most of its triangles have", "[geometry][mesh_check]")
{
    TriangleMesh tank = container_box({{0, 0, 0}, {1, 1, 1}}, {"+z"});
    const TriangleMesh before = tank;
    std::swap(tank.triangles[0][0], tank.triangles[0][1]); // the first one, which the others must not follow
    const MeshCheckReport report = check_mesh(tank, {.name = "tank.stl", .must_be_closed = false});
    CHECK(report.flipped_triangles == 1);
    CHECK(report.notes == std::vector<std::string>{"tank.stl: turned 1 of 10 triangles that faced against the others"});
    CHECK_FALSE(report.closed);
    CHECK(mass_properties(tank).volume == Approx(mass_properties(before).volume));

    TriangleMesh inward = flipped(before);
    CHECK(check_mesh(inward, {.must_be_closed = false}).flipped_triangles == 0);
}

TEST_CASE("walls may cross and branch", "[geometry][mesh_check]")
{
    TriangleMesh crossing = joined(tessellate(BoxShape{}, 1.0), box_at({0.1, 3, 0.1}, {0, 0, 0}));
    CHECK(check_mesh(crossing, {.must_be_closed = false}).closed);
    TriangleMesh branching = tessellate(BoxShape{}, 1.0);
    branching.vertices.emplace_back(3, 0, 0);
    branching.triangles.push_back({branching.triangles[0][0], branching.triangles[0][1], 8});
    CHECK_FALSE(check_mesh(branching, {.must_be_closed = false}).closed);
}

TEST_CASE("a closed mesh without volume is refused", "[geometry][mesh_check]")
{
    TriangleMesh flat = refined(tessellate(BoxShape{{1, 1, 1}}, 1.0), 0.7);
    for (Vec3d& vertex : flat.vertices)
        vertex.z() = 1e-9 * std::copysign(1.0, vertex.z()) * (vertex.z() == 0.0 ? 0.0 : 1.0);
    const std::string sentence = refusal(flat, {.name = "sheet.stl"});
    CHECK_THAT(sentence, Contains("sheet.stl "));
    CHECK(sentence != "(accepted)");

    TriangleMesh pillow; // two tents on one outline, both upward: no thickness
    pillow.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.4, 0.5, 0.2}, {0.41, 0.5, 0.2}};
    for (int k = 0; k < 4; ++k) {
        pillow.triangles.push_back({k, (k + 1) % 4, 4});
        pillow.triangles.push_back({(k + 1) % 4, k, 5});
    }
    CHECK_THAT(refusal(pillow, {.name = "pillow"}), Contains("pillow encloses no volume at (0.5, 0.5, 0.1)"));
}

TEST_CASE("a body must be larger than the particles resolve", "[geometry][mesh_check]")
{
    TriangleMesh plate = tessellate(BoxShape{{1.0, 0.5, 0.01}}, 1.0);
    const MeshCheckReport report = check_mesh(plate, {.name = "plate", .particle_spacing = 0.02});
    CHECK(report.notes ==
          std::vector<std::string>{"plate: its smallest extent, 0.01 m, is below the particle spacing of 0.02 m"});
    CHECK(refusal(plate, {.name = "plate", .particle_spacing = 0.6}) ==
          "plate measures 1 x 0.5 x 0.01 m, but particles with a spacing of 0.6 m resolve bodies of at least 1.2 m "
          "only; is it in metres?");
    CHECK(check_mesh(plate, {.must_be_closed = false, .particle_spacing = 0.6}).notes.empty());
    CHECK_THROWS_AS(check_mesh(plate, {.particle_spacing = -1.0}), std::invalid_argument);
    plate.part_of_triangle = {0, 1};
    CHECK_THROWS_AS(check_mesh(plate), std::invalid_argument);
}
