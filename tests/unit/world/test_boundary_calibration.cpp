#include "flotsam/sph/kernel.hpp"
#include "support/catch.hpp"
#include "world/boundary_calibration.hpp"

using namespace flotsam;

namespace {

/// A square lattice of samples d apart, of 15 x 15 in the plane z = 0 (a line of 15 in two dimensions).
std::vector<Vec3d> lattice(double d, int dimensions)
{
    std::vector<Vec3d> points;
    for (int x = 0; x < 15; ++x) {
        for (int y = 0; y < (dimensions == 3 ? 15 : 1); ++y) points.emplace_back(d * x, d * y, 0.0);
    }
    return points;
}

std::size_t middle(int dimensions)
{
    return dimensions == 3 ? 7 * 15 + 7 : 7;
}

} // namespace

TEST_CASE("a sample's volume is the calibrated part of what its neighbours leave it", "[world]")
{
    const int dimensions = GENERATE(2, 3);
    const KernelKind kernel_kind = GENERATE(KernelKind::quintic, KernelKind::cubic);
    const double d = 0.02;
    const std::vector<Vec3d> points = lattice(d, dimensions);
    const std::vector<double> depths(points.size(), boundary_calibration(kernel_kind, dimensions).inset * d);
    const std::vector<double> volumes = sample_volumes(points, depths, kernel_kind, d, dimensions);
    const Kernel kernel(kernel_kind, d, dimensions);
    const std::size_t at = middle(dimensions);
    double sum = 0.0; // brute force
    for (const Vec3d& p : points)
        sum += static_cast<double>(kernel.value(static_cast<Scalar>((p - points[at]).norm())));
    REQUIRE(volumes.size() == points.size());
    CHECK(volumes[at] == Approx(boundary_calibration(kernel_kind, dimensions).volume / sum).epsilon(1e-5)); // floats
    CHECK(volumes[0] > volumes[at]); // fewer neighbours, more room
}

TEST_CASE("sample volumes scale with the spacing", "[world]")
{
    const int dimensions = GENERATE(2, 3);
    const KernelKind kernel_kind = GENERATE(KernelKind::quintic, KernelKind::cubic);
    const std::size_t at = middle(dimensions);
    const auto volume = [&](double d) {
        const std::vector<Vec3d> points = lattice(d, dimensions);
        const std::vector<double> depths(points.size(), boundary_calibration(kernel_kind, dimensions).inset * d);
        return sample_volumes(points, depths, kernel_kind, d, dimensions)[at];
    };
    const double small = volume(0.01), large = volume(0.1);
    CHECK(large == Approx(std::pow(10.0, dimensions) * small).epsilon(1e-4)); // neighbours at 2 d count nothing
}

TEST_CASE("samples in the middle of a thin solid count less than deep ones", "[world]")
{
    const int dimensions = GENERATE(2, 3);
    const KernelKind kernel_kind = GENERATE(KernelKind::quintic, KernelKind::cubic);
    const double d = 0.02;
    const std::size_t at = middle(dimensions);
    const std::vector<Vec3d> points = lattice(d, dimensions);
    const std::vector<double> deep(points.size(), boundary_calibration(kernel_kind, dimensions).inset * d),
        flat(points.size(), 0.0);
    const double sheet = sample_volumes(points, flat, kernel_kind, d, dimensions)[at];
    CHECK(sheet > 0.0);
    CHECK(sheet < 0.6 * sample_volumes(points, deep, kernel_kind, d, dimensions)[at]);
}

TEST_CASE("samples lie inside the solid, not deeper than a spacing or two", "[world]")
{
    const int dimensions = GENERATE(2, 3);
    const KernelKind kernel_kind = GENERATE(KernelKind::quintic, KernelKind::cubic);
    CHECK(boundary_calibration(kernel_kind, dimensions).inset > 0.0);
    CHECK(boundary_calibration(kernel_kind, dimensions).inset < 2.0);
    CHECK(boundary_calibration(kernel_kind, dimensions).volume > 0.0);
}
