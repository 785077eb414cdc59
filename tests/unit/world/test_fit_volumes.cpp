#include "flotsam/geometry/shapes.hpp"
#include "flotsam/geometry/surface_samples.hpp"
#include "support/catch.hpp"
#include "world/boundary_calibration.hpp"
#include "world/fit_volumes.hpp"

#include <cmath>
#include <functional>
#include <numbers>

using namespace flotsam;

namespace {

constexpr double kD = 0.02; ///< particle spacing [m]

struct Sampled {
    std::vector<Vec3d> positions;
    std::vector<double> volumes;
};

Sampled sampled(const TriangleMesh& mesh, KernelKind kernel, int dimensions, double density, int threads = 1,
                bool fitted = true)
{
    const SurfaceQuery query(mesh);
    SurfaceSampleSettings sampling;
    sampling.spacing = 0.7 * kD;
    sampling.inset = boundary_calibration(kernel, dimensions).inset * kD;
    sampling.dimensions = dimensions;
    const SurfaceSamples samples = sample_surface(query, sampling);
    Sampled result{samples.positions, sample_volumes(samples.positions, samples.depth, kernel, kD, dimensions)};
    if (fitted)
        fit_volumes(query, {kernel, dimensions, kD, density}, result.positions, result.volumes, Workers(threads));
    return result;
}

/// What water at a point sees of the samples, as a part of what it would see of water in the solid's place, which a
/// fine lattice of it says.
double seen(const Sampled& samples, KernelKind kind, int dimensions, const Vec3d& point,
            const std::function<bool(const Vec3d&)>& is_solid)
{
    const Kernel kernel(kind, kD, dimensions);
    const double support = static_cast<double>(kernel.support()), step = kD / 8.0;
    const auto value = [&](double r) {
        return r < support ? static_cast<double>(kernel.value(static_cast<Scalar>(r))) : 0.0;
    };
    double have = 0.0, whole = 0.0;
    for (std::size_t b = 0; b < samples.positions.size(); ++b)
        have += samples.volumes[b] * value((samples.positions[b] - point).norm());
    const int reach = static_cast<int>(support / step) + 1, across = dimensions == 3 ? reach : 0;
    for (int x = -reach; x <= reach; ++x)
        for (int y = -across; y <= across; ++y)
            for (int z = -reach; z <= reach; ++z) {
                const Vec3d way = step * Vec3d(x + 0.5, dimensions == 3 ? y + 0.5 : 0.0, z + 0.5);
                if (is_solid(point + way)) whole += value(way.norm()) * std::pow(step, dimensions);
            }
    return have / whole;
}

Vec3d direction(int k, int dimensions)
{
    const double turn = 2.39996 * k, z = dimensions == 3 ? 1.0 - (k + 0.5) / 10.0 : std::sin(turn);
    const double rest = std::sqrt(1.0 - z * z);
    return dimensions == 3 ? Vec3d(rest * std::cos(turn), rest * std::sin(turn), z) : Vec3d(std::cos(turn), 0.0, z);
}

} // namespace

TEST_CASE("water in front of a round solid sees its volume, however small it is", "[world][fit]")
{
    const int dimensions = GENERATE(2, 3);
    const KernelKind kernel = GENERATE(KernelKind::quintic, KernelKind::cubic);
    const double radius = kD * GENERATE(2.0, 4.0);
    CAPTURE(dimensions, static_cast<int>(kernel), radius);
    const TriangleMesh mesh =
        dimensions == 3 ? tessellate(SphereShape{radius}, 0.5 * kD) : tessellate(DiscShape{radius}, 0.5 * kD);
    const Sampled samples = sampled(mesh, kernel, dimensions, 0.9);
    for (int k = 0; k < 20; ++k) {
        const Vec3d point = (radius + 0.5 * kD) * direction(k, dimensions);
        CHECK(seen(samples, kernel, dimensions, point, [&](const Vec3d& p) { return p.norm() < radius; }) ==
              Approx(0.9).epsilon(dimensions == 3 ? 0.03 : 0.06)); // a dozen samples in 2-D
    }
}

TEST_CASE("an edge is seen as an edge", "[world][fit]")
{
    const int dimensions = GENERATE(2, 3);
    CAPTURE(dimensions);
    const double half = 4.0 * kD, out = 0.5 * kD / std::numbers::sqrt2;
    const Vec3d edges = dimensions == 3 ? Vec3d(Vec3d::Constant(2.0 * half)) : Vec3d(2.0 * half, 1.0, 2.0 * half);
    const TriangleMesh mesh = tessellate(BoxShape{edges}, kD);
    const auto is_solid = [&](const Vec3d& p) {
        return std::max(std::abs(p.x()), std::abs(p.z())) < half && std::abs(p.y()) < 0.5 * edges.y();
    };
    const Sampled plain = sampled(mesh, KernelKind::quintic, dimensions, 0.9, 1, false),
                  fitted = sampled(mesh, KernelKind::quintic, dimensions, 0.9);
    const auto part = [&](const Sampled& samples, const Vec3d& point) {
        return seen(samples, KernelKind::quintic, dimensions, point, is_solid);
    };
    const Vec3d edge(half + out, 0.0, half + out), face(half + 0.5 * kD, 0.0, 0.3 * kD),
        near(half + 0.5 * kD, 0.0, half - 0.5 * kD);
    CHECK(part(plain, edge) < 0.6);
    CHECK(part(fitted, edge) > 0.68);
    CHECK(part(plain, near) < 0.8);
    CHECK(part(fitted, near) == Approx(0.9).margin(0.07));
    CHECK(part(fitted, face) == Approx(0.9).margin(0.04));
}

TEST_CASE("fitted volumes are bounded and the same for any number of threads", "[world][fit]")
{
    // A wedge, where one layer of samples in the middle would displace far too much.
    const TriangleMesh wedge = wigley_hull({.length = 0.4, .breadth = 0.16, .draft = 0.08, .freeboard = 0.06}, 24, 8);
    const Sampled plain = sampled(wedge, KernelKind::quintic, 3, 0.9, 1, false),
                  one = sampled(wedge, KernelKind::quintic, 3, 0.9),
                  two = sampled(wedge, KernelKind::quintic, 3, 0.9, 2);
    REQUIRE(plain.volumes.size() == one.volumes.size());
    CHECK(one.volumes == two.volumes);
    CHECK(one.volumes != plain.volumes);
    for (std::size_t b = 0; b < one.volumes.size(); ++b) {
        CHECK(one.volumes[b] <= 3.0 * plain.volumes[b]);
        CHECK(one.volumes[b] >= plain.volumes[b] / 3.0);
    }
}
