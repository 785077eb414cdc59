#include "support/catch.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/core/hash.hpp"
#include "flotsam/geometry/surface_samples.hpp"
#include "unit/geometry/sample_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace flotsam;
namespace meshes = test_meshes;
using Solid = SurfaceSampleSettings::Solid;

namespace {

constexpr double kD = 0.1; ///< spacing [m]

TriangleMesh centred_box(double x, double y, double z)
{
    const Vec3d half = 0.5 * kD * Vec3d(x, y, z);
    return meshes::box(-half, half);
}

SurfaceSampleSettings at_half_spacing(Solid solid, int dimensions = 3)
{
    return {.spacing = kD, .inset = 0.5 * kD, .dimensions = dimensions, .solid = solid};
}

/// Distance of each sample to its nearest neighbour, in spacings, ascending.
std::vector<double> nearest_neighbours(const SurfaceSamples& samples)
{
    std::vector<double> nearest;
    for (const Vec3d& p : samples.positions) {
        double best = 1e300;
        for (const Vec3d& q : samples.positions)
            if (&p != &q) best = std::min(best, (p - q).norm());
        nearest.push_back(best / kD);
    }
    std::sort(nearest.begin(), nearest.end());
    return nearest;
}

/// Largest distance, in spacings, of a point `inset` below the mesh to the next sample.
double largest_hole(const SurfaceQuery& query, const SurfaceSamples& samples, const SurfaceSampleSettings& settings)
{
    double largest = 0.0;
    const TriangleMesh& mesh = query.mesh();
    const double side = settings.solid == Solid::inside ? -1.0 : 1.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a;
        const Vec3d shift = side * settings.inset * ab.cross(ac).normalized();
        const int steps = std::max(1, static_cast<int>(std::max(ab.norm(), ac.norm()) / (0.3 * kD)));
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                const Vec3d p = a + static_cast<double>(i) / steps * ab + static_cast<double>(j) / steps * ac + shift;
                if (query.closest(p).distance < 0.999 * settings.inset) continue;
                double nearest = 1e300;
                for (const Vec3d& q : samples.positions) nearest = std::min(nearest, (p - q).norm());
                largest = std::max(largest, nearest / kD);
            }
    }
    return largest;
}

void check_even(const SurfaceQuery& query, const SurfaceSamples& samples, const SurfaceSampleSettings& settings)
{
    const std::vector<double> nearest = nearest_neighbours(samples);
    const double hole = largest_hole(query, samples, settings);
    INFO("nearest neighbours " << nearest.front() << " to " << nearest.back() << ", ratio "
                               << nearest.back() / nearest.front() << ", largest hole " << hole << " spacings");
    CHECK(nearest.front() > 0.74);
    CHECK(nearest.back() < 1.2);
    CHECK(hole < 0.85);
}

bool has_sample_at(const SurfaceSamples& samples, const Vec3d& p, double within)
{
    return std::any_of(samples.positions.begin(), samples.positions.end(),
                       [&](const Vec3d& q) { return (p - q).norm() <= within; });
}

std::uint64_t hash(const SurfaceSamples& samples)
{
    StateHash hash;
    for (const Vec3d& p : samples.positions) hash.add_bytes(p.data(), sizeof(double) * 3);
    return hash.value();
}

} // namespace

TEST_CASE("samples of a body lie evenly at the inset, over edges and corners", "[geometry][surface_samples]")
{
    const int shape = GENERATE(0, 1, 2, 3, 4);
    const TriangleMesh mesh = shape == 0   ? centred_box(8, 8, 8)
                              : shape == 1 ? centred_box(15.3, 6.7, 4.1)
                              : shape == 2 ? meshes::sphere(5.0 * kD, 24)
                              : shape == 3 ? meshes::disc(4.0 * kD, 40)
                                           : meshes::angle_bar(5.0 * kD, 3.0 * kD);
    const SurfaceQuery query(mesh);
    const SurfaceSampleSettings settings = at_half_spacing(Solid::inside);
    const SurfaceSamples samples = sample_surface(query, settings);
    REQUIRE(samples.positions.size() > 100);
    REQUIRE(samples.depth.size() == samples.positions.size());
    CHECK(samples.thin_fraction == 0.0);
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        CHECK(samples.depth[b] == 0.5 * kD);
        CHECK(query.signed_distance(samples.positions[b]) ==
              Approx(-0.5 * kD).epsilon(2e-3)); // the acceptance tolerance
    }
    check_even(query, samples, settings);
}

TEST_CASE("the number of samples is the area over the spacing squared", "[geometry][surface_samples]")
{
    const double radius = 6.0 * kD;
    const SurfaceQuery sphere(meshes::sphere(radius, 60));
    const auto count = static_cast<double>(sample_surface(sphere, at_half_spacing(Solid::inside)).positions.size());
    const double area = 4.0 * std::numbers::pi * std::pow(radius - 0.5 * kD, 2);
    CHECK(count * kD * kD == Approx(area).epsilon(0.02)); // candidates estimate the area
    const auto twice = static_cast<double>(
        sample_surface(sphere, {.spacing = 2.0 * kD, .inset = 0.5 * kD, .solid = Solid::inside}).positions.size());
    CHECK(twice * 4.0 * kD * kD == Approx(area).epsilon(0.04));
}

TEST_CASE("a box has samples in its corners and along its edges", "[geometry][surface_samples]")
{
    const SurfaceSamples samples = sample_surface(SurfaceQuery(centred_box(9, 9, 9)), at_half_spacing(Solid::inside));
    for (int k = 0; k < 8; ++k) {
        const Vec3d corner(k & 1 ? 4.0 : -4.0, k & 2 ? 4.0 : -4.0, k & 4 ? 4.0 : -4.0);
        CHECK(has_sample_at(samples, kD * corner, 1e-9));
    }
    for (int k = -4; k <= 4; ++k) CHECK(has_sample_at(samples, kD * Vec3d(4.0, k, 4.0), 1e-6 * kD));
}

TEST_CASE("the water side of a container is tight", "[geometry][surface_samples]")
{
    const bool open = GENERATE(true, false);
    const Vec3d size = kD * Vec3d(14.0, 9.0, 7.0);
    const SurfaceQuery query(open ? meshes::open_box(Vec3d::Zero(), size) : meshes::box(Vec3d::Zero(), size));
    const SurfaceSampleSettings settings = at_half_spacing(Solid::outside);
    const SurfaceSamples samples = sample_surface(query, settings);
    REQUIRE(samples.positions.size() > 300);
    const Aabb box{Vec3d::Zero(), size};
    for (const Vec3d& p : samples.positions) {
        CHECK_FALSE(box.contains(p));
        CHECK(query.closest(p).distance == Approx(0.5 * kD).epsilon(2e-3));
        if (open) CHECK(p.z() < size.z() + 1e-9); // it stops at the rim
    }
    check_even(query, samples, settings);

    // Around edges and corners: no point at the inset from them is far from a sample.
    const Vec3d corner = Vec3d::Zero(), edge(5.0 * kD, 0.0, 0.0);
    for (int k = 0; k <= 8; ++k) {
        const double angle = 0.5 * std::numbers::pi * k / 8.0, c = 0.5 * kD * std::cos(angle),
                     s = 0.5 * kD * std::sin(angle);
        CHECK(has_sample_at(samples, edge - Vec3d(0.0, c, s), 0.85 * kD));
        CHECK(has_sample_at(samples, corner - Vec3d(c, s, c).normalized() * 0.5 * kD, 0.85 * kD));
    }
    if (!open) return;
    for (double x = 0.0; x < size.x(); x += 0.5 * kD)
        CHECK(has_sample_at(samples, {x, -0.5 * kD, size.z()}, 0.55 * kD)); // a row runs along the rim
}

TEST_CASE("a sheet with water on both sides carries its samples", "[geometry][surface_samples]")
{
    const SurfaceQuery query(meshes::open_box(Vec3d::Zero(), kD * Vec3d(8.0, 6.0, 5.0)));
    const SurfaceSampleSettings settings{.spacing = kD, .inset = 0.0, .solid = Solid::both};
    const SurfaceSamples samples = sample_surface(query, settings);
    REQUIRE(samples.positions.size() > 150);
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        CHECK(query.closest(samples.positions[b]).distance < 1e-12);
        CHECK(samples.depth[b] == 0.0);
    }
    check_even(query, samples, settings);
    CHECK(samples.side.empty());
}

/// The samples of one side of a sheet.
SurfaceSamples side_of(const SurfaceSamples& samples, int side)
{
    SurfaceSamples part;
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        if (samples.side[b] != side) continue;
        part.positions.push_back(samples.positions[b]);
        part.depth.push_back(samples.depth[b]);
        part.normal.push_back(samples.normal[b]);
    }
    return part;
}

TEST_CASE("the sides of a sheet have a layer each, behind the face", "[geometry][surface_samples]")
{
    const int dimensions = GENERATE(2, 3);
    const bool open = GENERATE(false, true); // of no thickness, or of 0.6 spacings
    CAPTURE(dimensions, open);
    const Vec3d low = kD * Vec3d(-10, -10, 0), high = kD * Vec3d(10, 10, 8);
    const SurfaceQuery query(open ? meshes::open_box(low, high) : meshes::open_shell(low, high, 0.6 * kD));
    const SurfaceSamples samples =
        sample_surface(query, at_half_spacing(open ? Solid::both : Solid::inside, dimensions));
    CHECK(samples.thin_fraction == 0.0);
    REQUIRE(samples.side.size() == samples.positions.size());
    REQUIRE(samples.normal.size() == samples.positions.size());
    CHECK(*std::max_element(samples.side.begin(), samples.side.end()) == 1);
    for (int side = 0; side < 2; ++side) {
        const SurfaceSamples layer = side_of(samples, side);
        REQUIRE(layer.positions.size() > (dimensions == 2 ? 30u : 800u));
        CHECK(nearest_neighbours(layer).front() > 0.74);
        int outward = 0;
        for (std::size_t b = 0; b < layer.positions.size(); ++b) {
            const Vec3d face = layer.positions[b] + layer.depth[b] * layer.normal[b];
            CHECK(layer.depth[b] == Approx(0.5 * kD).epsilon(1e-3));
            CHECK(query.closest(face).distance <
                  0.21 * kD); // rows under edges are deeper than the depth along the normal
            outward += layer.normal[b].dot(face - Vec3d(0, 0, 4.0 * kD)) > 0.0 ? 1 : -1;
        }
        // One side faces out everywhere, the other in.
        CHECK(std::abs(outward) == static_cast<int>(layer.positions.size()));
    }
}

TEST_CASE("a plate thinner than two insets has two layers, a thick one is no sheet", "[geometry][surface_samples]")
{
    const SurfaceQuery plate(centred_box(10.0, 10.0, 0.6));
    const SurfaceSamples samples = sample_surface(plate, at_half_spacing(Solid::inside));
    CHECK(samples.thin_fraction == 0.0);
    REQUIRE_FALSE(samples.side.empty());
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        CHECK(samples.normal[b].cwiseAbs().z() == Approx(1.0));
        CHECK(samples.positions[b].z() == Approx(-0.2 * kD * samples.normal[b].z()).epsilon(1e-3)); // 0.3 - 0.5
    }
    CHECK(static_cast<double>(samples.positions.size()) == Approx(2.0 * 10.5 * 10.5).epsilon(0.1)); // rows at the rim

    const SurfaceSamples thick =
        sample_surface(SurfaceQuery(centred_box(10.0, 10.0, 2.5)), at_half_spacing(Solid::inside));
    CHECK(thick.thin_fraction == 0.0);
    CHECK(thick.side.empty());
}

TEST_CASE("rods and specks have samples inside", "[geometry][surface_samples]")
{
    const SurfaceQuery rod(centred_box(10.0, 0.6, 0.6));
    const SurfaceSamples along = sample_surface(rod, at_half_spacing(Solid::inside));
    CHECK(along.thin_fraction == 1.0);
    CHECK(along.positions.size() >= 7);
    CHECK(along.positions.size() <= 12);
    for (const Vec3d& p : along.positions) CHECK(p.tail<2>().norm() < 0.1 * kD);

    const SurfaceSamples speck =
        sample_surface(SurfaceQuery(centred_box(0.6, 0.6, 0.6)), at_half_spacing(Solid::inside));
    REQUIRE(speck.positions.size() == 1);
    CHECK(speck.positions[0].norm() < 0.05 * kD);
    CHECK(speck.depth[0] == Approx(0.3 * kD).epsilon(0.05));
}

TEST_CASE("a wedge is sampled out to its edge", "[geometry][surface_samples]")
{
    const SurfaceQuery wedge(meshes::prism({{0.0, 0.0}, {20.0 * kD, 1.5 * kD}, {0.0, 3.0 * kD}}, 4.0 * kD));
    const SurfaceSamples samples = sample_surface(wedge, at_half_spacing(Solid::inside));
    CHECK(samples.thin_fraction > 0.05);
    CHECK(samples.thin_fraction < 0.6);
    double farthest = 0.0;
    for (const Vec3d& p : samples.positions) {
        CHECK(wedge.signed_distance(p) < 0.0);
        farthest = std::max(farthest, p.x());
    }
    CHECK(farthest > 18.5 * kD);
}

TEST_CASE("a fin without thickness gets no samples outside", "[geometry][surface_samples]")
{
    TriangleMesh mesh = centred_box(8.0, 8.0, 4.0);
    const int first = static_cast<int>(mesh.vertices.size());
    for (const Vec3d& p : {Vec3d(6, 0, 0), Vec3d(9, 0, 0), Vec3d(9, 0, 3)}) mesh.vertices.emplace_back(kD * p);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 1});
    const SurfaceQuery query(mesh);
    const SurfaceSamples samples = sample_surface(query, at_half_spacing(Solid::inside));
    REQUIRE(samples.positions.size() > 100);
    for (const Vec3d& p : samples.positions) CHECK(query.signed_distance(p) < -0.49 * kD);
}

TEST_CASE("far from the origin samples are as good", "[geometry][surface_samples]")
{
    TriangleMesh mesh = centred_box(8.0, 6.0, 5.0);
    for (Vec3d& v : mesh.vertices) v += Vec3d(1000.0, -2000.0, 500.0);
    const SurfaceQuery query(mesh);
    const SurfaceSampleSettings settings = at_half_spacing(Solid::inside);
    const SurfaceSamples samples = sample_surface(query, settings);
    REQUIRE(samples.positions.size() > 100);
    check_even(query, samples, settings);
}

TEST_CASE("parts of a surface fit together whatever their order", "[geometry][surface_samples]")
{
    // A tank with one edge open, and a body with a fin: creases, a rim, and corners lie in some of the parts.
    const int shape = GENERATE(0, 1, 2);
    const bool backwards = GENERATE(false, true);
    TriangleMesh mesh = shape == 2 ? meshes::sphere(25.0 * kD, 40) : centred_box(47.0, 23.3, 24.0);
    if (shape == 1) {
        std::erase_if(mesh.triangles, [&](const auto& triangle) {
            return std::all_of(triangle.begin(), triangle.end(),
                               [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].z() > 0.0; });
        });
    }
    const SurfaceQuery query(mesh);
    const SurfaceSampleSettings settings = at_half_spacing(shape == 2 ? Solid::inside : Solid::outside);
    const std::size_t whole = sample_surface(query, settings).positions.size();
    SurfaceSampler sampler(query, settings, 20.0 * kD);
    REQUIRE(sampler.parts() == (shape == 2 ? 8u : 2u));
    SurfaceSamples all;
    for (std::size_t k = 0; k < sampler.parts(); ++k) {
        const std::size_t part = backwards ? sampler.parts() - 1 - k : k;
        CHECK_FALSE(sampler.is_sampled(part));
        const SurfaceSampler::Part found = sampler.sample(part, Workers(2));
        CHECK(sampler.is_sampled(part));
        REQUIRE(found.samples.positions.size() > 100);
        CHECK(found.samples.depth.size() == found.samples.positions.size());
        for (const Vec3d& p : found.samples.positions) {
            bool is_here = false;
            const Vec3d gap = Vec3d::Constant(kD); // just beyond its border it may have filled one
            sampler.visit_parts({p - gap, p + gap}, [&](std::size_t at) { is_here = is_here || at == part; });
            CHECK(is_here);
        }
        all.positions.insert(all.positions.end(), found.samples.positions.begin(), found.samples.positions.end());
    }
    check_even(query, all, settings);
    CHECK(static_cast<double>(all.positions.size()) == Approx(static_cast<double>(whole)).epsilon(0.02));
    CHECK_THROWS_AS(sampler.sample(0, Workers(1)), std::invalid_argument);
    CHECK_THROWS_AS(SurfaceSampler(query, settings, 5.0 * kD), std::invalid_argument);
}

TEST_CASE("the same input gives the same samples, another seed others", "[geometry][surface_samples]")
{
    const SurfaceQuery query(centred_box(6.0, 5.0, 4.0));
    SurfaceSampleSettings settings = at_half_spacing(Solid::inside);
    const std::uint64_t first = hash(sample_surface(query, settings));
    CHECK(hash(sample_surface(SurfaceQuery(centred_box(6.0, 5.0, 4.0)), settings)) == first);
    settings.seed = 2;
    CHECK(hash(sample_surface(query, settings)) != first);
}

TEST_CASE("settings of samples that make no sense are refused", "[geometry][surface_samples]")
{
    const SurfaceQuery query(centred_box(6.0, 5.0, 4.0));
    CHECK_THROWS_AS(sample_surface(query, {.spacing = 0.0}), std::invalid_argument);
    CHECK_THROWS_AS(sample_surface(query, {.spacing = std::nan("")}), std::invalid_argument);
    CHECK_THROWS_AS(sample_surface(query, {.spacing = kD, .inset = -0.1}), std::invalid_argument);
    CHECK_THROWS_AS(sample_surface(query, {.spacing = kD, .dimensions = 1}), std::invalid_argument);
    const SurfaceQuery beside(meshes::box({0, 1, 0}, {1, 2, 1}));
    CHECK_THROWS_AS(sample_surface(beside, {.spacing = kD, .dimensions = 2}), InputError);
}

TEST_CASE("outlines in two dimensions are even", "[geometry][surface_samples][2d]")
{
    const int shape = GENERATE(0, 1, 2, 3, 4, 5);
    const bool body = shape < 3;
    const TriangleMesh mesh = shape == 0   ? centred_box(12.0, 10.0, 12.0)
                              : shape == 1 ? centred_box(24.0, 10.0, 8.0)
                              : shape == 2 ? meshes::disc(6.0 * kD, 60)
                              : shape == 3 ? meshes::open_box(kD * Vec3d(0, -5, 0), kD * Vec3d(40, 5, 20))
                              : shape == 4 ? meshes::open_box(kD * Vec3d(0, -5, 0), kD * Vec3d(40.37, 5, 20.41))
                                           : meshes::box(kD * Vec3d(0, -5, 0), kD * Vec3d(30, 5, 20));
    const SurfaceQuery query(mesh);
    const SurfaceSamples samples = sample_surface(query, at_half_spacing(body ? Solid::inside : Solid::outside, 2));
    REQUIRE(samples.positions.size() > 30);
    const std::vector<double> nearest = nearest_neighbours(samples);
    CHECK(nearest.back() / nearest.front() < 1.1);
    CHECK(nearest.front() > 0.95);
    for (const Vec3d& p : samples.positions) {
        CHECK(p.y() == 0.0);
        CHECK(query.closest(p).distance == Approx(0.5 * kD).epsilon(2e-3));
        CHECK(query.inside(p) == body);
    }
    if (shape == 0) {
        CHECK(samples.positions.size() == 44);
        CHECK(has_sample_at(samples, kD * Vec3d(5.5, 0.0, -5.5), 1e-9));
    }
    if (shape == 3) {
        CHECK(has_sample_at(samples, kD * Vec3d(-0.5, 0.0, 20.0), 1e-9)); // the rim
        CHECK(has_sample_at(samples, -0.5 * kD * Vec3d(1.0, 0.0, 1.0).normalized(), 1e-9));
    }
}

TEST_CASE("thin parts in two dimensions have one row", "[geometry][surface_samples][2d]")
{
    const SurfaceSamples bar =
        sample_surface(SurfaceQuery(centred_box(0.95, 10.0, 0.6)), at_half_spacing(Solid::inside, 2));
    CHECK(bar.positions.size() >= 1);
    CHECK(bar.positions.size() <= 2);
    CHECK(bar.thin_fraction == 1.0);
    for (const Vec3d& p : bar.positions) CHECK(std::abs(p.z()) < 0.05 * kD);

    const SurfaceSamples speck =
        sample_surface(SurfaceQuery(centred_box(0.6, 10.0, 0.6)), at_half_spacing(Solid::inside, 2));
    REQUIRE(speck.positions.size() == 1);
    CHECK(speck.positions[0].norm() < 0.05 * kD);

    const SurfaceQuery wedge(meshes::prism({{0.0, 0.0}, {20.0 * kD, 1.5 * kD}, {0.0, 3.0 * kD}}, 0.5));
    const SurfaceSamples bow = sample_surface(wedge, at_half_spacing(Solid::inside, 2));
    const std::vector<double> nearest = nearest_neighbours(bow);
    CHECK(nearest.back() < 1.1);
    CHECK(bow.thin_fraction > 0.1);
}

TEST_CASE("an inner corner in two dimensions is rounded", "[geometry][surface_samples][2d]")
{
    const SurfaceQuery query(meshes::angle_bar(6.0 * kD, 0.5));
    const SurfaceSamples samples = sample_surface(query, at_half_spacing(Solid::inside, 2));
    const Vec3d corner(6.0 * kD, 0.0, 6.0 * kD);
    CHECK(has_sample_at(samples, corner - 0.5 * kD * Vec3d(1.0, 0.0, 1.0).normalized(), 1e-6));
    for (const Vec3d& p : samples.positions) CHECK(query.signed_distance(p) == Approx(-0.5 * kD).epsilon(2e-3));
    const std::vector<double> nearest = nearest_neighbours(samples);
    CHECK(nearest.back() / nearest.front() < 1.1);
}
