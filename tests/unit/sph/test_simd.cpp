#include "sph/simd/instruction_sets.hpp"
#include "sph/simd/pair_sums.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <random>

using namespace flotsam;

namespace {

using Mat3 = Mat3d;

/// Restores the best instruction set however the test ends.
struct InstructionSet {
    explicit InstructionSet(const std::string& name) { simd::use_instruction_set(name); }
    ~InstructionSet() { simd::use_instruction_set(""); }
    InstructionSet(const InstructionSet&) = delete;
    InstructionSet& operator=(const InstructionSet&) = delete;
};

struct Points {
    static constexpr double kSpacing = 0.1;
    std::vector<Vec4> position, velocity, strain;
    std::vector<Scalar> weights;

    explicit Points(std::size_t count)
    {
        std::mt19937 random(static_cast<unsigned>(count));
        std::uniform_real_distribution<Scalar> value(-1, 1);
        const Scalar size = static_cast<Scalar>(kSpacing * std::cbrt(static_cast<double>(count + 1)) / 2.0);
        for (std::size_t i = 0; i < count; ++i) {
            position.emplace_back(size * value(random), size * value(random), size * value(random), 0);
            velocity.emplace_back(value(random), value(random), value(random), 0);
            strain.emplace_back(value(random), value(random), value(random), value(random));
            weights.push_back(Scalar(2) + value(random));
        }
    }
};

Vec3d wide(const Vec4& p)
{
    return p.head<3>().cast<double>();
}

/// Of xx in at.w and yy, xy, xz, yz in `rest`.
Mat3 deviator(const Vec4& at, const Vec4& rest)
{
    const Eigen::Vector4d r = rest.cast<double>();
    const double xx = static_cast<double>(at[3]);
    Mat3 m;
    m << xx, r[1], r[2], r[1], r[0], r[3], r[2], r[3], -xx - r[0];
    return m;
}

void check_vec(const Vec3d& found, const Vec3d& expected, double size)
{
    CHECK((found - expected).norm() <= 2e-6 * size); // single precision, a few dozen terms
}

} // namespace

TEMPLATE_TEST_CASE("every instruction set finds the pairs and sums of plain loops in double precision", "[sph][oracle]",
                   QuinticSpline, CubicSpline)
{
    // Row lengths of 0 to about 90, so that every rest of a register occurs.
    const std::size_t count = GENERATE(0u, 1u, 2u, 40u, 257u, 1200u);
    const bool far = GENERATE(false, true); // neighbours by their numbers, or by differences
    const std::vector<std::string> sets = simd::instruction_sets();
    REQUIRE_FALSE(sets.empty());
    CAPTURE(count, far);
    Points points(count);
    const TestType kernel(2.5 * Points::kSpacing, 3);
    const Workers workers(2);
    const CellGrid grid = CellGrid::around(points.position, {}, static_cast<double>(kernel.support()), 4000);
    CellLists lists;
    lists.build(grid, points.position, workers);
    for (const std::string& name : sets) {
        CAPTURE(name);
        const InstructionSet taken(name);
        Pairs weighted_pairs;
        NeighbourSearch().find(kernel, grid, lists, points.position, true, points.weights, workers, weighted_pairs);
        SelfPairs pairs;
        NeighbourSearch().find(kernel, grid, lists, points.position, workers, pairs);
        REQUIRE(pairs.start == weighted_pairs.start);
        REQUIRE_FALSE(pairs.is_far());
        if (far) {
            std::copy_n(weighted_pairs.index.begin(), pairs.size(), std::back_inserter(pairs.index));
            pairs.index.resize(pairs.size() + SelfPairs::kSlack);
            pairs.offset.clear();
        }
        REQUIRE(pairs.rows() == count);
        const double volume = std::pow(Points::kSpacing, 3);
        simd::ViscousPull pull;
        pull.viscosity = Scalar(0.01);
        pull.width = Scalar(0.02);
        pull.most = Scalar(0.03);
        pull.softening_sq = Scalar(1e-4);
        std::vector<Vec4> at = points.position, fast = points.velocity;
        for (std::size_t i = 0; i < count; ++i) {
            at[i][3] = points.weights[i];
            fast[i][3] = points.strain[i][3];
        }
        std::vector<Vec4> gradients(count), squares(count), pulls(count);
        std::vector<Scalar> divergences(count);
        std::vector<simd::LinearFit> fits(count);
        simd::sum_gradients(pairs, at, 0, count, gradients);
        simd::sum_divergences(pairs, points.position, points.velocity, 0, count, divergences);
        simd::sum_gradient_squares(pairs, points.position, 0, count, squares);
        simd::fit_linear(pairs, points.position, points.velocity, 0, count, fits.data());
        simd::sum_viscous_pulls(pairs, at, fast, points.strain, pull, 0, count, pulls);
        std::vector<std::array<Scalar, 6>> virials(count);
        std::vector<Vec4> smooth_at(count), smooth_rest(count), pushes(count);
        simd::sum_virials(pairs, at, 0, count, virials.data());
        simd::smooth_deviators(pairs, at, points.strain, 0, count, smooth_at, smooth_rest);
        simd::sum_deviator_pushes(pairs, at, points.strain, 0, count, pushes);
        for (std::size_t i = 0; i < count; ++i) {
            std::vector<std::uint32_t> expected, found;
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) found.push_back(pairs.neighbour(i, k));
            CHECK(std::equal(found.begin(), found.end(), weighted_pairs.index.begin() + pairs.start[i]));
            std::vector<Scalar> slopes(count);
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k)
                slopes[pairs.neighbour(i, k)] = pairs.slope(k);
            double kernel_sum = 0.0, divergence = 0.0, square = 0.0, size = 0.0, pull_size = 0.0;
            Vec3d gradient = Vec3d::Zero(), plain = Vec3d::Zero(), pulled = Vec3d::Zero();
            Mat3 velocity = Mat3::Zero(), shape = Mat3::Zero(), virial = Mat3::Zero(), weighted = Mat3::Zero();
            double weights = 0.0;
            Vec3d pushed = Vec3d::Zero();
            const auto strain_of = [&](std::size_t k) {
                const Vec4& s = points.strain[k];
                Mat3 m;
                m << double(at[k][3]), double(s[1]), double(s[2]), double(s[1]), double(fast[k][3]), double(s[3]),
                    double(s[2]), double(s[3]), double(s[0]);
                return m;
            };
            for (std::uint32_t j = 0; j < count; ++j) {
                const Vec4 offset = points.position[i] - points.position[j];
                if (j == i || !(offset.squaredNorm() < kernel.support() * kernel.support())) continue;
                expected.push_back(j);
                const Vec3d x = wide(offset), v = wide(points.velocity[i]) - wide(points.velocity[j]);
                const Scalar r = offset.norm();
                CHECK(std::abs(slopes[j] - kernel.gradient_factor(r)) <=
                      Scalar(-0.6) * pairs.unit); // half, and rounding
                const Vec3d g = static_cast<double>(slopes[j]) * x;
                kernel_sum += static_cast<double>(points.weights[j]) * static_cast<double>(kernel.value(r));
                gradient += static_cast<double>(at[j][3]) * g;
                plain += g;
                divergence += wide(points.velocity[j]).dot(g);
                square += g.squaredNorm();
                size += g.norm();
                velocity -= v * g.transpose();
                shape -= x * g.transpose();
                const double s = x.dot(v), distance_sq = x.squaredNorm() + 1e-4;
                const double q =
                    std::clamp(s - x.dot((strain_of(i) + strain_of(j)) * x), std::min(s, 0.0), std::max(s, 0.0));
                const double strength = 0.01 * s + std::min(0.03, 0.02 * std::abs(q) / std::sqrt(distance_sq)) * q;
                pulled += strength / distance_sq * g;
                pull_size += std::abs(s) / distance_sq * g.norm();
                virial += (static_cast<double>(at[i][3]) + static_cast<double>(at[j][3])) * g * x.transpose();
                weights -= g.dot(x);
                weighted -= g.dot(x) * deviator(at[j], points.strain[j]);
                const Mat3 both = deviator(at[i], points.strain[i]) + deviator(at[j], points.strain[j]);
                pushed += x.dot(both * x) / x.squaredNorm() * g;
            }
            std::sort(found.begin(), found.end());
            REQUIRE(found == expected);
            CHECK(static_cast<double>(weighted_pairs.kernel_sum[i]) * volume ==
                  Approx(kernel_sum * volume).epsilon(2e-6).margin(1e-9));
            check_vec(wide(gradients[i]), gradient, 3.0 * size);
            CHECK(gradients[i][3] == 0);
            CHECK(std::abs(static_cast<double>(divergences[i]) - divergence) <= 1e-5 * size);
            check_vec(wide(squares[i]), plain, size);
            CHECK(static_cast<double>(squares[i][3]) == Approx(square).epsilon(1e-5));
            check_vec(wide(pulls[i]), pulled, pull_size);
            for (int k = 0; k < 9; ++k) {
                CHECK(std::abs(static_cast<double>(fits[i].velocity[static_cast<std::size_t>(k)]) -
                               velocity(k / 3, k % 3)) <= 1e-5 * size);
            }
            const std::array<std::pair<int, int>, 6> places = {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
            for (std::size_t k = 0; k < 6; ++k) {
                CHECK(std::abs(static_cast<double>(fits[i].shape[k]) - shape(places[k].first, places[k].second)) <=
                      1e-5 * size * Points::kSpacing);
                CHECK(std::abs(static_cast<double>(virials[i][k]) - virial(places[k].first, places[k].second)) <=
                      4e-5 * size * Points::kSpacing);
            }
            check_vec(wide(pushes[i]), pushed, 30.0 * size);
            CHECK(wide(smooth_at[i]) == wide(at[i]));
            const Mat3 expected_mean = weights > 0.0 ? Mat3(weighted / weights) : Mat3::Zero();
            CHECK((deviator(smooth_at[i], smooth_rest[i]) - expected_mean).norm() <= 1e-4);
        }
    }
}

TEST_CASE("an instruction set that the processor does not have is refused", "[sph]")
{
    CHECK_THROWS(simd::use_instruction_set("abacus"));
}
