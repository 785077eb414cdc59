#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <random>

using namespace flotsam;

namespace {

std::vector<Vec4> random_points(std::size_t count, unsigned seed, double size)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<Scalar> place(0, static_cast<Scalar>(size));
    std::vector<Vec4> points(count);
    for (Vec4& p : points) p = Vec4(place(random), place(random), place(random), 0);
    return points;
}

} // namespace

TEST_CASE("neighbours are those of brute force", "[sph][oracle]")
{
    const std::size_t count = GENERATE(0u, 1u, 2u, 255u, 256u, 257u, 900u);
    const std::size_t max_cells = GENERATE(8u, 100000u); // few cells: points outside fall into border cells
    const int threads = GENERATE(1, 2);
    const double support = 0.15;
    const std::vector<Vec4> a = random_points(count, 1, 1.0), b = random_points(count / 2 + 1, 2, 1.0);
    const Workers workers(threads);
    const CellGrid grid = CellGrid::around(a, b, support, max_cells);
    CHECK(grid.size() <= max_cells);
    CellLists of_a, of_b;
    of_a.build(grid, a, workers);
    of_b.build(grid, b, workers);
    const CubicSpline kernel(support, 3);
    const bool same = GENERATE(true, false);
    const std::vector<Vec4>& others = same ? a : b;
    NeighbourSearch search;
    Pairs pairs;
    search.find(kernel, grid, same ? of_a : of_b, a, same, {}, workers, pairs);
    REQUIRE(pairs.rows() == count);
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t j = 0; j < others.size(); ++j) {
            const bool near = (a[i] - others[j]).head<3>().squaredNorm() < static_cast<Scalar>(support * support);
            if (near && !(same && i == j)) expected.push_back(j);
        }
        std::vector<std::uint32_t> found(pairs.index.begin() + pairs.start[i],
                                         pairs.index.begin() + pairs.start[i + 1]);
        std::sort(found.begin(), found.end());
        CHECK(found == expected);
    }
}

TEST_CASE("a point far away costs no memory and no neighbour is lost", "[sph]")
{
    std::vector<Vec4> points = random_points(100, 3, 0.2);
    points.push_back(Vec4(Scalar(1e6), 0, 0, 0));
    points.push_back(Vec4(Scalar(1e6) + Scalar(0.0625), 0, 0, 0));
    const Workers workers(1);
    const CellGrid grid = CellGrid::around(points, {}, 0.1, 5000);
    CHECK(grid.size() <= 5000);
    CellLists cells;
    cells.build(grid, points, workers);
    NeighbourSearch search;
    Pairs pairs;
    search.find(CubicSpline(0.1, 3), grid, cells, points, true, {}, workers, pairs);
    CHECK(pairs.start[101] - pairs.start[100] == 1);
    CHECK(pairs.start[102] - pairs.start[101] == 1);
}

TEMPLATE_TEST_CASE("pairs of points whose numbers differ by more than 16 bits hold are kept by numbers", "[sph]",
                   QuinticSpline, CubicSpline)
{
    // In the order of their cells, but for a point that is the last and lies beside the first.
    constexpr std::uint32_t kCount = 40000;
    std::vector<Vec4> points;
    for (std::uint32_t i = 0; i + 1 < kCount; ++i) points.emplace_back(static_cast<Scalar>(i), 0, 0, 0);
    points.emplace_back(Scalar(0.25), 0, 0, 0);
    const TestType kernel(1.125, 3);
    const Workers workers(2);
    const auto find = [&](SelfPairs& pairs) {
        const CellGrid grid = CellGrid::around(points, {}, 1.125, 100000);
        CellLists lists;
        lists.build(grid, points, workers);
        NeighbourSearch().find(kernel, grid, lists, points, workers, pairs);
        const auto row = [&](std::uint32_t i) {
            std::vector<std::uint32_t> found;
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
                found.push_back(pairs.neighbour(i, k));
                const Scalar r = (points[i] - points[found.back()]).norm();
                CHECK(std::abs(pairs.slope(k) - kernel.gradient_factor(r)) <= Scalar(-0.501) * pairs.unit);
            }
            std::sort(found.begin(), found.end());
            return found;
        };
        CHECK(row(5) == std::vector<std::uint32_t>{4, 6});
        CHECK(row(20000) == std::vector<std::uint32_t>{19999, 20001});
        return row(0);
    };
    SelfPairs pairs;
    CHECK(find(pairs) == std::vector<std::uint32_t>{1, kCount - 1});
    CHECK(pairs.is_far());
    points.back().x() = static_cast<Scalar>(kCount - 1);
    CHECK(find(pairs) == std::vector<std::uint32_t>{1});
    CHECK_FALSE(pairs.is_far());
}

TEST_CASE("water squeezed into a corner has rows of many hundred neighbours", "[sph]")
{
    const std::size_t count = GENERATE(512u, 513u, 514u, 1400u);
    const std::vector<Vec4> points = random_points(count, 5, 0.05);
    const Workers workers(2);
    const CubicSpline kernel(0.15, 3);
    const CellGrid grid = CellGrid::around(points, {}, 0.15, 1000);
    CellLists lists;
    lists.build(grid, points, workers);
    SelfPairs pairs;
    NeighbourSearch().find(kernel, grid, lists, points, workers, pairs);
    REQUIRE(pairs.size() == count * (count - 1));
    for (std::size_t i = 0; i < count; i += 100) {
        std::vector<char> is_found(count);
        double sum = 0.0;
        for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
            const std::uint32_t j = pairs.neighbour(i, k);
            is_found[j] = 1;
            const Scalar r = (points[i] - points[j]).norm();
            CHECK(std::abs(pairs.slope(k) - kernel.gradient_factor(r)) <= Scalar(-0.6) * pairs.unit);
            sum += static_cast<double>(kernel.value(r));
        }
        CHECK(std::count(is_found.begin(), is_found.end(), 1) == static_cast<std::ptrdiff_t>(count) - 1);
        CHECK(is_found[i] == 0);
        CHECK(static_cast<double>(pairs.kernel_sum[i]) == Approx(sum).epsilon(1e-5));
    }
}

TEST_CASE("layers of cells lie across the longest axis of the points, rows along the next", "[sph]")
{
    const std::vector<Vec4> points = {Vec4(0, 0, 0, 0), Vec4(3, 9, 5, 0)};
    const CellGrid grid = CellGrid::around(points, {}, 1.0, 1000);
    const std::uint32_t home = grid.index_of({1, 1, 1});
    CHECK(grid.index_of({1, 1, 2}) == home + 1);
    CHECK(grid.index_of({2, 1, 1}) == home + static_cast<std::uint32_t>(grid.cells.z()));
    CHECK(grid.index_of({1, 2, 1}) == home + static_cast<std::uint32_t>(grid.cells.z() * grid.cells.x()));
}
