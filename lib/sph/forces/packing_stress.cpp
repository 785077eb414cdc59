#include "sph/forces/packing_stress.hpp"

#include "sph/simd/pair_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flotsam {
namespace {

constexpr Scalar kMost = Scalar(0.03); ///< |<T>| / p

/// Of the deviator whose xx stands in at[3] and whose yy, xy, xz, yz are `rest`.
Scalar norm(const Vec4& at, const Vec4& rest)
{
    const Scalar xx = at[3], yy = rest[0], zz = -xx - yy;
    return std::sqrt(xx * xx + yy * yy + zz * zz + Scalar(2) * rest.tail<3>().squaredNorm());
}

} // namespace

void relieve_packing_stress(const PackingStressSettings& settings, double dt, const FluidState& fluid,
                            const Pairs& fluid_pairs, const Pairs& boundary_pairs, const Workers& workers,
                            const ForceScratch& scratch, std::span<Vec4> velocity)
{
    const std::size_t n = fluid.size();
    for (std::vector<Vec4>* values : scratch) values->resize(n);
    std::vector<Vec4>&at = *scratch[0], &raw_at = *scratch[1], &raw_rest = *scratch[2], &rest = *scratch[3];
    const Scalar trace_share = Scalar(1) / static_cast<Scalar>(settings.dimensions);
    const Scalar to_stress = static_cast<Scalar>(-0.5 * fluid.particle_mass * settings.rest_density);

    workers.for_each(n, [&](std::size_t i) {
        at[i] = fluid.position[i];
        at[i][3] = fluid.pressure[i] / (fluid.density[i] * fluid.density[i]);
    });
    workers.for_chunks(n, [&](std::size_t, std::size_t begin, std::size_t end) {
        std::array<std::array<Scalar, 6>, Workers::kChunk> virials;
        simd::sum_virials(fluid_pairs, at, begin, end, virials.data());
        for (std::size_t i = begin; i < end; ++i) {
            const std::array<Scalar, 6>& v = virials[i - begin];
            const bool at_solid = boundary_pairs.start[i] < boundary_pairs.start[i + 1];
            const Scalar factor = at_solid ? Scalar(0) : to_stress;
            const Scalar mean = trace_share * (v[0] + v[1] + v[2]);
            raw_at[i] = fluid.position[i];
            raw_at[i][3] = factor * (v[0] - mean);
            raw_rest[i] = factor * Vec4(settings.dimensions == 2 ? v[1] : v[1] - mean, v[3], v[4], v[5]);
        }
    });
    workers.for_chunks(n, [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::smooth_deviators(fluid_pairs, raw_at, raw_rest, begin, end, at, rest);
        for (std::size_t i = begin; i < end; ++i) {
            const Scalar most = kMost * fluid.pressure[i], length = norm(at[i], rest[i]);
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
