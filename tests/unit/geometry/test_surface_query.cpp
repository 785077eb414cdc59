#include "support/catch.hpp"

#include "flotsam/geometry/surface_query.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>

using namespace flotsam;
namespace meshes = test_meshes;

namespace {

class Random {
  public:
    double uniform(double low, double high)
    {
        return low + (high - low) * static_cast<double>(engine_()) / static_cast<double>(engine_.max());
    }
    Vec3d in_box(double half)
    {
        const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
        return {x, y, z};
    }

  private:
    std::mt19937 engine_{7};
};

TriangleMesh soup(int triangles, Random& random)
{
    TriangleMesh mesh;
    for (int t = 0; t < triangles; ++t) {
        const Vec3d middle = random.in_box(1.0);
        for (int k = 0; k < 3; ++k) mesh.vertices.emplace_back(middle + random.in_box(0.4));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

TriangleMesh with_triangles(int count, Random& random)
{
    if (count == 12) return meshes::box({-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3});
    return soup(count, random);
}

double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b)
{
    const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - along * (b - a)).norm();
}

/// By the plane where the foot of p lies inside, by the edges elsewhere.
double distance_to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    const Vec3d normal = (b - a).cross(c - a).normalized();
    const Vec3d foot = p - normal.dot(p - a) * normal;
    const bool inside = normal.dot((b - a).cross(foot - a)) >= 0.0 && normal.dot((c - b).cross(foot - b)) >= 0.0 &&
                        normal.dot((a - c).cross(foot - c)) >= 0.0;
    if (inside) return std::abs(normal.dot(p - a));
    return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

double volume_of(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d)
{
    return (b - a).dot((c - a).cross(d - a));
}

/// Where a segment crosses a triangle, with how clearly it does: margin > 0 hits, < 0 misses.
struct Crossing {
    double margin, fraction;
};
Crossing crossing(const Vec3d& from, const Vec3d& to, const TriangleMesh& mesh, std::size_t t)
{
    const Vec3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const double start = volume_of(from, a, b, c), end = volume_of(to, a, b, c);
    const double across = start > 0.0 ? 1.0 : -1.0;
    const double u = across * volume_of(from, to, a, b), v = across * volume_of(from, to, b, c),
                 w = across * volume_of(from, to, c, a);
    const double plane = std::min(across * start, -across * end);
    const double in_one_way = std::min({u, v, w}), in_the_other = std::min({-u, -v, -w});
    return {std::min(plane, std::max(in_one_way, in_the_other)), start / (start - end)};
}

} // namespace

TEST_CASE("the closest point agrees with a search over all triangles", "[geometry][surface_query]")
{
    Random random;
    const int triangles = GENERATE(1, 2, 12, 3, 500);
    const TriangleMesh mesh = with_triangles(triangles, random);
    const SurfaceQuery query(mesh);
    for (int k = 0; k < 300; ++k) {
        Vec3d p = random.in_box(1.5);
        if (k % 3 == 0) p = query.closest(p).point; // on the surface
        if (k % 10 == 0) p = mesh.vertices[static_cast<std::size_t>(k) % mesh.vertices.size()];
        double expected = 1e300;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            expected =
                std::min(expected, distance_to_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)));
        const auto closest = query.closest(p);
        REQUIRE(closest.distance == Approx(expected).margin(1e-12));
        CHECK((closest.point - p).norm() == Approx(closest.distance).margin(1e-14));
        const auto t = static_cast<std::size_t>(closest.triangle);
        CHECK(distance_to_triangle(closest.point, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)) < 1e-12);
    }
}

TEST_CASE("a surface needs triangles", "[geometry][surface_query]")
{
    CHECK_THROWS_AS(SurfaceQuery(TriangleMesh{}), std::invalid_argument);
}

TEST_CASE("degenerate triangles have a distance", "[geometry][surface_query]")
{
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}};
    mesh.triangles = {{0, 1, 2}, {3, 3, 3}};
    const SurfaceQuery query(mesh);
    CHECK(query.closest({1.5, 1.0, 0.0}).distance == Approx(1.0));
    CHECK(query.closest({5, 5, 6}).distance == Approx(1.0));
    CHECK(std::isfinite(query.winding_number({0.5, 0.5, 0.5})));
    CHECK_FALSE(query.sweep({1.5, 1.0, 0.2}, {1.5, -1.0, 0.1}).has_value());
}

TEST_CASE("the winding number tells inside from outside", "[geometry][surface_query]")
{
    Random random;
    const TriangleMesh mesh = GENERATE(meshes::box({-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}), meshes::sphere(1.0, 40));
    const SurfaceQuery query(mesh);
    int inside = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3d p = random.in_box(1.2);
        const auto closest = query.closest(p);
        if (closest.distance < 1e-9) continue;
        // both are convex about the origin
        const bool expected = (closest.point - p).dot(closest.point) > 0.0;
        inside += expected ? 1 : 0;
        CHECK(query.winding_number(p) == Approx(expected ? 1.0 : 0.0).margin(0.05)); // the tree's far field
        CHECK(query.inside(p) == expected);
        CHECK(query.signed_distance(p) == Approx(expected ? -closest.distance : closest.distance));
    }
    CHECK(inside > 200);
}

TEST_CASE("a cavity is outside, an open box half and half", "[geometry][surface_query]")
{
    TriangleMesh shell = meshes::sphere(1.0, 16), cavity = meshes::sphere(0.5, 16);
    const int offset = static_cast<int>(shell.vertices.size());
    shell.vertices.insert(shell.vertices.end(), cavity.vertices.begin(), cavity.vertices.end());
    for (const auto& [a, b, c] : cavity.triangles) shell.triangles.push_back({a + offset, c + offset, b + offset});
    const SurfaceQuery query(shell);
    CHECK_FALSE(query.inside(Vec3d::Zero()));
    CHECK(query.inside({0.75, 0.0, 0.0}));
    CHECK(query.signed_distance(Vec3d::Zero()) == Approx(0.5).epsilon(0.02)); // of a tessellated sphere

    const SurfaceQuery open(meshes::open_box(Vec3d::Zero(), Vec3d::Ones()));
    CHECK(open.winding_number({0.5, 0.5, 0.5}) == Approx(5.0 / 6.0));
    CHECK(open.winding_number({0.5, 0.5, 1.0}) == Approx(0.5));
}

TEST_CASE("a sweep finds the first crossing that a search over all triangles finds", "[geometry][surface_query]")
{
    Random random;
    const int triangles = GENERATE(1, 2, 12, 400);
    const TriangleMesh mesh = with_triangles(triangles, random);
    const SurfaceQuery query(mesh);
    const double clear = 1e-9; // [m^3] of the volumes that decide; closer calls may go either way
    int hits = 0, misses = 0;
    for (int k = 0; k < 3000; ++k) {
        const Vec3d from = random.in_box(1.3), to = k % 2 ? random.in_box(1.3) : Vec3d(from + random.in_box(0.2));
        double first = 2.0;
        bool unclear = false;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Crossing at = crossing(from, to, mesh, t);
            if (std::abs(at.margin) < clear) unclear = true;
            if (at.margin > 0.0) first = std::min(first, at.fraction);
        }
        if (unclear) continue;
        const auto hit = query.sweep(from, to);
        REQUIRE(hit.has_value() == (first < 1.5));
        ++(hit ? hits : misses);
        if (!hit) continue;
        CHECK(hit->fraction == Approx(first).margin(1e-9));
        CHECK(hit->normal.norm() == Approx(1.0));
        CHECK(hit->normal.dot(to - from) < 0.0);
        const auto t = static_cast<std::size_t>(hit->triangle);
        CHECK(distance_to_triangle(from + hit->fraction * (to - from), mesh.corner(t, 0), mesh.corner(t, 1),
                                   mesh.corner(t, 2)) < 1e-9);
    }
    CHECK(hits > 5);
    CHECK(misses > 5);
}

TEST_CASE("no way leads out of a closed surface unseen", "[geometry][surface_query]")
{
    Random random;
    TriangleMesh mesh = GENERATE(meshes::box({-0.7, -0.5, -0.3}, {0.7, 0.5, 0.3}), meshes::sphere(0.8, 9));
    for (Vec3d& v : mesh.vertices) // no round numbers
        v = Quatd(Eigen::AngleAxisd(0.7, Vec3d(1, 2, 3).normalized())) * v + Vec3d(0.123, 3.21, -12.3);
    const SurfaceQuery query(mesh);
    const Vec3d middle = query.bounds().center();
    const auto leaves = [&](const Vec3d& through) {
        const Vec3d inside = middle + random.in_box(0.1),
                    outside = through + random.uniform(0.3, 3.0) * (through - inside);
        CHECK(query.sweep(inside, outside).has_value());
        CHECK(query.sweep(outside, inside).has_value());
        // in two steps that meet on the surface, give or take a rounding
        const bool first = query.sweep(inside, through).has_value(), second = query.sweep(through, outside).has_value();
        CHECK((first || second));
    };
    for (const Vec3d& v : mesh.vertices) leaves(v);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3d a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
            leaves(0.5 * (a + b));
            leaves(a + random.uniform(0.0, 1.0) * (b - a));
        }
    for (int k = 0; k < 500; ++k) leaves(query.closest(middle + random.in_box(1.0)).point);
}

TEST_CASE("sweeps of special directions", "[geometry][surface_query]")
{
    const SurfaceQuery query(meshes::box({0, 0, 0}, {1, 1, 1}));
    SECTION("along an axis, through a face's diagonal")
    {
        const auto hit = query.sweep({0.5, 0.5, 2.0}, {0.5, 0.5, 0.0});
        REQUIRE(hit.has_value());
        CHECK(hit->fraction == Approx(0.5));
        CHECK((hit->normal - Vec3d::UnitZ()).norm() < 1e-15);
    }
    SECTION("from inside the normal still points against the motion")
    {
        const auto hit = query.sweep({0.5, 0.4, 0.5}, {0.5, 0.4, 1.5});
        REQUIRE(hit.has_value());
        CHECK((hit->normal + Vec3d::UnitZ()).norm() < 1e-15);
    }
    SECTION("no way is no crossing")
    {
        CHECK_FALSE(query.sweep({0.5, 0.5, 1.0}, {0.5, 0.5, 1.0}).has_value());
    }
    SECTION("short of the surface")
    {
        CHECK_FALSE(query.sweep({0.5, 0.5, 2.0}, {0.5, 0.5, 1.0 + 1e-9}).has_value());
    }
    SECTION("beside the surface")
    {
        CHECK_FALSE(query.sweep({1.0 + 1e-9, 0.5, 2.0}, {1.0 + 1e-9, 0.5, -1.0}).has_value());
    }
    SECTION("from the surface on counts")
    {
        const auto hit = query.sweep({0.5, 0.4, 1.0}, {0.5, 0.4, 2.0});
        REQUIRE(hit.has_value());
        CHECK(hit->fraction == 0.0);
    }
    SECTION("two sheets a hair apart: the first")
    {
        const SurfaceQuery sheets(meshes::box({0, 0, 0}, {1, 1, 1e-9}));
        const auto down = sheets.sweep({0.3, 0.4, 1.0}, {0.3, 0.4, -1.0}),
                   up = sheets.sweep({0.3, 0.4, -1.0}, {0.3, 0.4, 1.0});
        REQUIRE(down.has_value());
        REQUIRE(up.has_value());
        CHECK(down->normal.z() > 0.0);
        CHECK(up->normal.z() < 0.0);
        CHECK(sheets.mesh().corner(static_cast<std::size_t>(down->triangle), 0).z() == 1e-9);
        CHECK(sheets.mesh().corner(static_cast<std::size_t>(up->triangle), 0).z() == 0.0);
    }
}

TEST_CASE("queries from several threads agree", "[geometry][surface_query]")
{
    const SurfaceQuery query(meshes::sphere(1.0, 20));
    const auto sum = [&] {
        Random random;
        double total = 0.0;
        for (int k = 0; k < 500; ++k) {
            const Vec3d p = random.in_box(1.3), q = random.in_box(1.3);
            total += query.signed_distance(p) + (query.sweep(p, q) ? query.sweep(p, q)->fraction : 0.0);
        }
        return total;
    };
    std::vector<double> totals(3, 0.0);
    std::vector<std::thread> threads;
    threads.reserve(totals.size());
    for (double& total : totals) threads.emplace_back([&total, &sum] { total = sum(); });
    for (std::thread& thread : threads) thread.join();
    for (double total : totals) CHECK(total == sum());
}
