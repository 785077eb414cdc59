#include "flotsam/sph/density.hpp"
#include "flotsam/sph/kernel.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <numbers>

using namespace flotsam;

TEMPLATE_TEST_CASE("a spline integrates to one and its gradient is its derivative", "[sph][kernel][derivative]",
                   CubicSpline, QuinticSpline)
{
    const int dimensions = GENERATE(2, 3);
    const double support = 0.05;
    const TestType kernel(support, dimensions);
    double integral = 0.0;
    const int n = 4000;
    for (int k = 0; k < n; ++k) {
        const double r = (k + 0.5) * support / n;
        const double shell = dimensions == 3 ? 4.0 * std::numbers::pi * r * r : 2.0 * std::numbers::pi * r;
        integral += static_cast<double>(kernel.value(static_cast<Scalar>(r))) * shell * support / n;
    }
    CHECK(integral == Approx(1.0).epsilon(1e-4));
    for (const double q : {0.1, 0.3, 0.49, 0.51, 0.7, 0.9}) {
        const double r = q * support, dr = 1e-3 * support; // float values: a wide step
        const double slope = (static_cast<double>(kernel.value(static_cast<Scalar>(r + dr))) -
                              static_cast<double>(kernel.value(static_cast<Scalar>(r - dr)))) /
                             (2.0 * dr);
        CHECK(static_cast<double>(kernel.gradient_factor(static_cast<Scalar>(r))) * r == Approx(slope).epsilon(5e-3));
    }
    CHECK(kernel.value(static_cast<Scalar>(support)) == 0);
    CHECK(kernel.value(static_cast<Scalar>(2.0 * support)) == 0);
}

TEST_CASE("a cubic lattice of one spacing has rest density", "[sph][density]")
{
    const int dimensions = GENERATE(2, 3);
    const double d = 0.02;
    const KernelKind kind = GENERATE(KernelKind::quintic, KernelKind::cubic);
    const Kernel kernel(kind, d, dimensions);
    CHECK(static_cast<double>(kernel.support()) == Approx(Kernel::support_in_spacings(kind) * d));
    double sum = 0.0;
    for (int x = -3; x <= 3; ++x) {
        for (int y = -3; y <= 3; ++y) {
            for (int z = dimensions == 3 ? -3 : 0; z <= (dimensions == 3 ? 3 : 0); ++z) {
                sum += static_cast<double>(kernel.value(static_cast<Scalar>(d * std::sqrt(x * x + y * y + z * z))));
            }
        }
    }
    CHECK(sum * std::pow(d, dimensions) == Approx(1.0).epsilon(dimensions == 3 ? 5e-4 : 2e-3));
}

TEST_CASE("worked example: three unit masses at r = 0, 1, 1.5 of a poly6 kernel of radius 2", "[sph][density]")
{
    const Poly6Kernel2d kernel(2.0);
    const std::vector<Vec4> points = {Vec4(0, 0, 0, 0), Vec4(1, 0, 0, 0), Vec4(0, 0, Scalar(-1.5), 0)};
    const Workers workers(1);
    const CellGrid grid = CellGrid::around(points, {}, 2.0, 1000);
    CellLists cells;
    cells.build(grid, points, workers);
    NeighbourSearch search;
    Pairs pairs;
    search.find(kernel, grid, cells, points, true, {}, workers, pairs);
    const std::vector<Scalar> no_boundary(points.size());
    std::vector<Scalar> density(points.size());
    compute_density(pairs.kernel_sum, no_boundary, kernel.value(0), 1.0, 1.0, workers, density);
    // W = 0.3183, 0.1343, 0.0267; density 0.479; with rest density 0.4 and stiffness 100 the pressure is 7.925.
    CHECK(static_cast<double>(kernel.value(0)) == Approx(0.3183).margin(5e-5));
    CHECK(static_cast<double>(kernel.value(1)) == Approx(0.1343).margin(5e-5));
    CHECK(static_cast<double>(kernel.value(Scalar(1.5))) == Approx(0.0267).margin(5e-5));
    CHECK(static_cast<double>(density[0]) == Approx(0.479).margin(5e-4));
    CHECK(linear_equation_of_state(static_cast<double>(density[0]), 0.4, 100.0) == Approx(7.925).margin(5e-3));
}
