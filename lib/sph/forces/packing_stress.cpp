#include "sph/forces/packing_stress.hpp"

#include "sph/forces/velocity_gradient.hpp"
#include "sph/simd/pair_sums.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace flotsam {
namespace {

constexpr Scalar kMost = Scalar(0.03); ///< |<T>| / p

/// Symmetric, without trace: `at`[3] is xx, and `rest` yy, xy, xz, yz.
Scalar product(Scalar xx, const Vec4& rest, Scalar other_xx, const Vec4& other_rest)
{
    const Scalar yy = rest[0], other_yy = other_rest[0];
    return xx * other_xx + yy * other_yy + (xx + yy) * (other_xx + other_yy) +
           Scalar(2) * rest.tail<3>().dot(other_rest.tail<3>());
}

/// Leaves of the stress (xx, rest) the part along the strain rate.
void project(const Eigen::Matrix<Scalar, 3, 3>& gradient, int dimensions, Scalar& xx, Vec4& rest)
{
    const Scalar mean = gradient.trace() / static_cast<Scalar>(dimensions), half = Scalar(0.5);
    const Scalar strain_xx = gradient(0, 0) - mean;
    const Vec4 strain(dimensions == 2 ? Scalar(0) : gradient(1, 1) - mean, half * (gradient(0, 1) + gradient(1, 0)),
                      half * (gradient(0, 2) + gradient(2, 0)), half * (gradient(1, 2) + gradient(2, 1)));
    const Scalar length_sq = product(strain_xx, strain, strain_xx, strain);
    const Scalar share = length_sq > 0 ? product(xx, rest, strain_xx, strain) / length_sq : Scalar(0);
    xx = share * strain_xx;
    rest = share * strain;
}

bool touches(const Pairs& boundary_pairs, std::size_t i)
{
    return boundary_pairs.start[i] < boundary_pairs.start[i + 1];
}

} // namespace

void PackingStress::find_second_layer(const SelfPairs& fluid_pairs, const Pairs& boundary_pairs, const Workers& workers)
{
    const std::size_t n = fluid_pairs.start.size() - 1;
    second_layer_.assign(n, 0);
    workers.for_each(n, [&](std::size_t i) {
        if (!touches(boundary_pairs, i)) return;
        for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k)
            std::atomic_ref(second_layer_[fluid_pairs.neighbour(i, k)]).store(1, std::memory_order_relaxed);
    });
}

void PackingStress::relieve(const PackingStressSettings& settings, double dt, const FluidState& fluid,
                            const SelfPairs& fluid_pairs, const Pairs& boundary_pairs, const Workers& workers,
                            const ForceScratch& scratch, std::span<Vec4> velocity)
{
    const std::size_t n = fluid.size();
    for (std::vector<Vec4>* values : scratch) values->resize(n);
    std::vector<Vec4>&at = *scratch[0], &raw_at = *scratch[1], &raw_rest = *scratch[2], &rest = *scratch[3];
    const Scalar trace_share = Scalar(1) / static_cast<Scalar>(settings.dimensions);
    const Scalar volume = static_cast<Scalar>(fluid.particle_mass / settings.rest_density);
    const Scalar to_stress = static_cast<Scalar>(-0.5 * fluid.particle_mass * settings.rest_density);

    find_second_layer(fluid_pairs, boundary_pairs, workers);
    workers.for_each(n, [&](std::size_t i) {
        at[i] = fluid.position[i];
        at[i][3] = fluid.pressure[i] / (fluid.density[i] * fluid.density[i]);
    });
    workers.for_chunks(n, [&](std::size_t, std::size_t begin, std::size_t end) {
        std::array<std::array<Scalar, 6>, Workers::kChunk> virials;
        simd::sum_virials(fluid_pairs, at, begin, end, virials.data());
        for (std::size_t i = begin; i < end; ++i) {
            const std::array<Scalar, 6>& v = virials[i - begin];
            const Scalar factor = touches(boundary_pairs, i) ? Scalar(0) : to_stress;
            const Scalar mean = trace_share * (v[0] + v[1] + v[2]);
            raw_at[i] = fluid.position[i];
            raw_at[i][3] = factor * (v[0] - mean);
            raw_rest[i] = factor * Vec4(settings.dimensions == 2 ? v[1] : v[1] - mean, v[3], v[4], v[5]);
        }
    });
    workers.for_chunks(n, [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::smooth_deviators(fluid_pairs, raw_at, raw_rest, begin, end, at, rest);
        for (std::size_t i = begin; i < end; ++i) {
            if (second_layer_[i] != 0) {
                simd::LinearFit fit;
                simd::fit_linear(fluid_pairs, fluid.position, fluid.velocity, i, i + 1, &fit);
                project(velocity_gradient(fit, volume, settings.dimensions), settings.dimensions, at[i][3], rest[i]);
            }
            const Scalar most = kMost * fluid.pressure[i];
            const Scalar length = std::sqrt(product(at[i][3], rest[i], at[i][3], rest[i]));
            if (length <= most) continue;
            at[i][3] *= most / length;
            rest[i] *= most / length;
        }
    });
    const double rho0 = settings.rest_density;
    const Scalar factor = static_cast<Scalar>(settings.relief * dt * 0.5 * (settings.dimensions + 2) *
                                              fluid.particle_mass / (rho0 * rho0));
    std::vector<Vec4>& push = raw_at;
    workers.for_chunks(n, [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_deviator_pushes(fluid_pairs, at, rest, begin, end, push);
        for (std::size_t i = begin; i < end; ++i) velocity[i] += factor * push[i];
    });
}

} // namespace flotsam
