#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/geometry/triangle_mesh.hpp"
#include "support/catch.hpp"

#include <limits>
#include <map>

using namespace flotsam;

namespace {

double longest_edge(const TriangleMesh& mesh)
{
    double longest = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            longest = std::max(longest, (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm());
    return longest;
}

/// Every directed edge has its opposite exactly once.
bool is_watertight(const TriangleMesh& mesh)
{
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        if (count != 1 || opposite == edges.end()) return false;
    }
    return true;
}

} // namespace

TEST_CASE("bounds hold every vertex and nothing more", "[geometry]")
{
    const TriangleMesh box = tessellate(BoxShape{{1.0, 2.0, 3.0}}, 1.0);
    CHECK(bounds(box).min == Vec3d(-0.5, -1.0, -1.5));
    CHECK(bounds(box).max == Vec3d(0.5, 1.0, 1.5));
    CHECK(bounds(TriangleMesh{}).empty());
}

TEST_CASE("a transformed mesh has its vertices where the pose puts them", "[geometry]")
{
    const TriangleMesh box = tessellate(BoxShape{{1.0, 2.0, 3.0}}, 1.0);
    const Pose pose{{4.0, 5.0, 6.0}, Quatd(Eigen::AngleAxisd(0.7, Vec3d(1, 2, -1).normalized()))};
    const TriangleMesh moved = transformed(box, pose);
    for (std::size_t v = 0; v < box.vertices.size(); ++v)
        CHECK((moved.vertices[v] - pose.to_world(box.vertices[v])).norm() < 1e-14);
}

TEST_CASE("a flipped mesh has the opposite volume", "[geometry]")
{
    const TriangleMesh box = tessellate(BoxShape{{1.0, 2.0, 3.0}}, 1.0);
    CHECK(mass_properties(flipped(box)).volume == Approx(-6.0));
}

TEST_CASE("joined meshes keep their triangles and parts apart", "[geometry]")
{
    TriangleMesh named = tessellate(BoxShape{}, 1.0);
    named.part_names = {"hull"};
    const TriangleMesh both = joined(named, tessellate(SphereShape{}, 1.0));
    CHECK(both.part_names == std::vector<std::string>{"hull", ""});
    REQUIRE(both.part_of_triangle.size() == both.triangles.size());
    CHECK(both.part_of_triangle.front() == 0);
    CHECK(both.part_of_triangle.back() == 1);
    CHECK(mass_properties(both).volume == Approx(1.0 + 3.14159265358979 / 6.0).epsilon(1e-12));
    CHECK(joined(TriangleMesh{}, named).triangles == named.triangles);
    CHECK(joined(named, TriangleMesh{}).triangles == named.triangles);
}

TEST_CASE("refining reaches the edge length, stays watertight and changes no volume", "[geometry]")
{
    const double max_edge = GENERATE(0.05, 0.3, 0.9);
    const TriangleMesh slab = tessellate(BoxShape{{1.0, 0.5, 0.03}}, 1.0); // long thin sides split unevenly
    const TriangleMesh fine = refined(slab, max_edge);
    REQUIRE(longest_edge(slab) > max_edge);
    CHECK(longest_edge(fine) <= max_edge);
    CHECK(longest_edge(fine) > 0.4 * max_edge); // not far beyond what was asked for
    CHECK(is_watertight(fine));
    CHECK(mass_properties(fine).volume == Approx(0.015).epsilon(1e-12));
}

TEST_CASE("refining keeps each triangle's part", "[geometry]")
{
    const TriangleMesh two = joined(tessellate(BoxShape{}, 1.0),
                                    transformed(tessellate(BoxShape{}, 1.0), Pose{Vec3d(9, 0, 0), Quatd::Identity()}));
    const TriangleMesh fine = refined(two, 0.4);
    REQUIRE(fine.part_of_triangle.size() == fine.triangles.size());
    for (std::size_t t = 0; t < fine.triangles.size(); ++t)
        CHECK((fine.corner(t, 0).x() > 5.0) == (fine.part_of_triangle[t] == 1));
}

TEST_CASE("refining refuses an edge length that is not positive and vertices that are not finite", "[geometry]")
{
    TriangleMesh box = tessellate(BoxShape{}, 1.0);
    CHECK_THROWS_AS(refined(box, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(refined(box, std::nan("")), std::invalid_argument);
    box.vertices[3].x() = 1.0 / 0.0;
    CHECK_THROWS_AS(refined(box, 0.1), std::invalid_argument);
}

TEST_CASE("tessellated shapes are watertight and have exactly the shape's volume", "[geometry]")
{
    const double pi = 3.14159265358979323846;
    const double max_edge = GENERATE(10.0, 0.11, 0.03);
    const TriangleMesh sphere = tessellate(SphereShape{0.4}, max_edge);
    const TriangleMesh cylinder = tessellate(CylinderShape{0.3, 0.7}, max_edge);
    const TriangleMesh disc = tessellate(DiscShape{0.25}, max_edge);
    for (const TriangleMesh* mesh : {&sphere, &cylinder, &disc}) CHECK(is_watertight(*mesh));
    CHECK(mass_properties(sphere).volume == Approx(4.0 / 3.0 * pi * 0.064).epsilon(1e-13));
    CHECK(mass_properties(cylinder).volume == Approx(pi * 0.09 * 0.7).epsilon(1e-13));
    CHECK(mass_properties(disc).volume == Approx(pi * 0.0625).epsilon(1e-13));
    CHECK(bounds(cylinder).size().z() == Approx(0.7).epsilon(1e-15));
    CHECK(bounds(disc).size().y() == Approx(1.0).epsilon(1e-15));
    // Beside the least number of segments, edges are "around" what was asked: scaling to volume stretches them.
    if (max_edge < 0.1) {
        CHECK(longest_edge(sphere) < 1.02 * max_edge);
        CHECK(longest_edge(cylinder) < 1.5 * max_edge); // diagonals
        CHECK(longest_edge(cylinder) > 0.5 * max_edge);
    }
}

TEST_CASE("a mesh shape comes back as it is", "[geometry]")
{
    const TriangleMesh box = tessellate(BoxShape{{1, 2, 3}}, 0.1);
    CHECK(box.triangles.size() == 12);
    CHECK(tessellate(MeshShape{box}, 0.1).vertices == box.vertices);
}

TEST_CASE("shapes refuse sizes that are not positive", "[geometry]")
{
    CHECK_THROWS_AS(tessellate(BoxShape{{1, 0, 1}}, 0.1), std::invalid_argument);
    CHECK_THROWS_AS(tessellate(SphereShape{-1}, 0.1), std::invalid_argument);
    CHECK_THROWS_AS(tessellate(CylinderShape{1, std::nan("")}, 0.1), std::invalid_argument);
    CHECK_THROWS_AS(tessellate(DiscShape{0}, 0.1), std::invalid_argument);
    CHECK_THROWS_AS(tessellate(DiscShape{1}, 0), std::invalid_argument);
    CHECK_THROWS_WITH(tessellate(SphereShape{1}, 1e-6),
                      "max_edge must be at least 1/5000 of the sphere radius, given 1e-06");
}

TEST_CASE("a Wigley hull is closed, whatever its stations, and its vertices lie on it", "[geometry]")
{
    const double freeboard = GENERATE(0.0, 0.07);
    const int stations = GENERATE(2, 3, 12), levels = GENERATE(1, 4);
    const WigleyHull sizes{1.0, 0.2, 0.1, freeboard};
    TriangleMesh hull = wigley_hull(sizes, stations, levels);
    CAPTURE(freeboard, stations, levels);
    CHECK(is_watertight(hull));
    CHECK(bounds(hull).min.z() == Approx(-0.1));
    CHECK(bounds(hull).max.z() == Approx(freeboard).margin(1e-12));
    for (const Vec3d& v : hull.vertices) {
        const double below = std::min(v.z(), 0.0) / sizes.draft, along = 2.0 * v.x() / sizes.length;
        CHECK(std::abs(v.y()) == Approx(0.1 * (1.0 - along * along) * (1.0 - below * below)).margin(1e-12));
    }
    const MeshCheckReport found = check_mesh(hull);
    CHECK(found.parts == 1);
    CHECK(found.welded_vertices == 0);
    CHECK(found.dropped_triangles == 0);
    CHECK(found.flipped_triangles == 0);
}

TEST_CASE("a Wigley hull refuses sizes that are not positive and too few pieces", "[geometry]")
{
    CHECK_THROWS_WITH(wigley_hull({0.0, 0.2, 0.1}, 8, 4), "the length of a hull must be > 0 m and finite, given 0");
    CHECK_THROWS_AS(wigley_hull({1.0, -0.2, 0.1}, 8, 4), std::invalid_argument);
    CHECK_THROWS_AS(wigley_hull({1.0, 0.2, std::numeric_limits<double>::quiet_NaN()}, 8, 4), std::invalid_argument);
    CHECK_THROWS_AS(wigley_hull({1.0, 0.2, 0.1, -0.01}, 8, 4), std::invalid_argument);
    CHECK_THROWS_AS(wigley_hull({}, 1, 4), std::invalid_argument);
    CHECK_THROWS_AS(wigley_hull({}, 8, 0), std::invalid_argument);
}

TEST_CASE("a container has its closed sides only, facing away from the water", "[geometry]")
{
    const Aabb box{{0, 0, 0}, {1, 2, 3}};
    CHECK(mass_properties(container_box(box, {})).volume == Approx(6.0));
    const TriangleMesh floor = container_box(box, {"-x", "+x", "-y", "+y", "+z"});
    REQUIRE(floor.triangles.size() == 2);
    CHECK(floor.vertices.size() == 4);
    CHECK(bounds(floor).max == Vec3d(1, 2, 0));
    for (std::size_t t = 0; t < 2; ++t) {
        const Vec3d normal = (floor.corner(t, 1) - floor.corner(t, 0)).cross(floor.corner(t, 2) - floor.corner(t, 0));
        CHECK(normal.normalized() == Vec3d(0, 0, -1));
    }
    CHECK(container_box(box, {"+z"}).triangles.size() == 10);
}

TEST_CASE("a container refuses unknown sides, empty boxes and no sides at all", "[geometry]")
{
    const Aabb box{{0, 0, 0}, {1, 2, 3}};
    CHECK_THROWS_WITH(
        container_box(box, {"top"}),
        "open sides of a container must be \"-x\", \"+x\", \"-y\", \"+y\", \"-z\" or \"+z\", given \"top\"");
    CHECK_THROWS_AS(container_box({{0, 0, 0}, {1, 0, 1}}, {}), std::invalid_argument);
    CHECK_THROWS_AS(container_box(box, {"-x", "+x", "-y", "+y", "-z", "+z"}), std::invalid_argument);
}
