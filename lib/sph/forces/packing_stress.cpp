#include "sph/forces/packing_stress.hpp"

#include "sph/forces/velocity_gradient.hpp"
#include "sph/simd/pair_sums.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace flotsam {
namespace {

constexpr Scalar kMost = Scalar(0.03);         ///< |<T>| / p
constexpr Scalar kMostAtBodies = Scalar(0.12); ///< the same along bodies that move
constexpr Scalar kWhole = 255;                 ///< of moved_
constexpr double kParticlesPerSample = 0.72;   ///< over rho0 V_b / m

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

/// x^T T x.
Scalar along(const Vec4& x, Scalar xx, const Vec4& rest)
{
    return x[0] * x[0] * xx + x[1] * x[1] * rest[0] - x[2] * x[2] * (xx + rest[0]) +
           Scalar(2) * (x[0] * x[1] * rest[1] + x[0] * x[2] * rest[2] + x[1] * x[2] * rest[3]);
}

bool touches(const Pairs& boundary_pairs, std::size_t i)
{
    return boundary_pairs.start[i] < boundary_pairs.start[i + 1];
}

/// Adds the pairs with samples of a particle at x, y, z, p / rho^2 to its sum_virials, and returns the unit normal away
/// from them (0: there is none).
Vec4 add_samples(const TouchedSolids& solids, std::size_t i, const Vec4& at, Scalar samples_per_volume,
                 std::array<Scalar, 6>& virial)
{
    Vec4 normal = Vec4::Zero();
    for (std::uint32_t k = solids.pairs.start[i]; k < solids.pairs.start[i + 1]; ++k) {
        const std::uint32_t b = solids.pairs.index[k];
        Vec4 x = at - solids.boundary.position[b];
        x[3] = 0;
        const Scalar slope = solids.boundary.volume[b] * solids.pairs.slope[k];
        normal -= slope * x;
        const Scalar f = samples_per_volume * at[3] * slope;
        virial[0] += f * x[0] * x[0], virial[1] += f * x[1] * x[1], virial[2] += f * x[2] * x[2];
        virial[3] += f * x[0] * x[1], virial[4] += f * x[0] * x[2], virial[5] += f * x[1] * x[2];
    }
    const Scalar length = normal.norm();
    return length > 0 ? Vec4(normal / length) : Vec4(Vec4::Zero());
}

/// Of a stress (xx, rest) the part across a surface, times `factor`: n^T T n (n n - I / dim) dim / (dim - 1).
void keep_across(const Vec4& normal, int dimensions, Scalar factor, Scalar& xx, Vec4& rest)
{
    const Scalar share = Scalar(1) / static_cast<Scalar>(dimensions);
    const Scalar across = factor / (Scalar(1) - share) * along(normal, xx, rest);
    xx = across * (normal[0] * normal[0] - share);
    rest << (dimensions == 2 ? Scalar(0) : across * (normal[1] * normal[1] - share)), across * normal[0] * normal[1],
        across * normal[0] * normal[2], across * normal[1] * normal[2];
}

/// The mean of smooth_deviators over the particles that touch samples; of i alone if there is no other.
void mean_of_touching(const SelfPairs& fluid_pairs, const Pairs& boundary_pairs, std::span<const Vec4> at,
                      std::span<const Vec4> rest, std::size_t i, Scalar& mean_xx, Vec4& mean_rest)
{
    Scalar sum = 0, xx = 0;
    Vec4 others = Vec4::Zero();
    for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k) {
        const std::size_t j = fluid_pairs.neighbour(i, k);
        if (!touches(boundary_pairs, j)) continue;
        const Scalar weight = -fluid_pairs.slope(k) * (at[i] - at[j]).head<3>().squaredNorm();
        sum += weight;
        xx += weight * at[j][3];
        others += weight * rest[j];
    }
    mean_xx = sum > 0 ? xx / sum : at[i][3];
    mean_rest = sum > 0 ? Vec4(others / sum) : rest[i];
}

} // namespace

void PackingStress::find_layers(const SelfPairs& fluid_pairs, const TouchedSolids& solids, const Workers& workers)
{
    const std::size_t n = fluid_pairs.rows();
    second_layer_.assign(n, 0);
    moved_.assign(n, 0);
    const bool any_moves = std::any_of(solids.moving.begin(), solids.moving.end(), [](Scalar m) { return m > 0; });
    workers.for_each(n, [&](std::size_t i) {
        if (!touches(solids.pairs, i)) return;
        for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k)
            std::atomic_ref(second_layer_[fluid_pairs.neighbour(i, k)]).store(1, std::memory_order_relaxed);
        if (!any_moves) return;
        Scalar all = 0, moving = 0;
        for (std::uint32_t k = solids.pairs.start[i]; k < solids.pairs.start[i + 1]; ++k) {
            const std::uint32_t b = solids.pairs.index[k];
            const Scalar weight = -solids.boundary.volume[b] * solids.pairs.slope[k];
            all += weight;
            moving += weight * solids.moving[static_cast<std::size_t>(solids.boundary.owner[b])];
        }
        if (all > 0) moved_[i] = static_cast<std::uint8_t>(std::lround(kWhole * moving / all));
    });
}

void PackingStress::relieve(const PackingStressSettings& settings, double dt, const FluidState& fluid,
                            const SelfPairs& fluid_pairs, const TouchedSolids& solids, const Workers& workers,
                            const ForceScratch& scratch, std::span<Vec4> velocity, std::span<Wrench> owner_impulses)
{
    const std::size_t n = fluid.size();
    for (std::vector<Vec4>* values : scratch) values->resize(n);
    std::vector<Vec4>&at = *scratch[0], &raw_at = *scratch[1], &raw_rest = *scratch[2], &rest = *scratch[3];
    const Scalar trace_share = Scalar(1) / static_cast<Scalar>(settings.dimensions);
    const Scalar volume = static_cast<Scalar>(fluid.particle_mass / settings.rest_density);
    const Scalar to_stress = static_cast<Scalar>(-0.5 * fluid.particle_mass * settings.rest_density);
    const Scalar samples_per_volume = static_cast<Scalar>(settings.rest_density / fluid.particle_mass);

    find_layers(fluid_pairs, solids, workers);
    workers.for_each(n, [&](std::size_t i) {
        at[i] = fluid.position[i];
        at[i][3] = fluid.pressure[i] / (fluid.density[i] * fluid.density[i]);
    });
    workers.for_chunks(n, [&](std::size_t, std::size_t begin, std::size_t end) {
        std::array<std::array<Scalar, 6>, Workers::kChunk> virials;
        simd::sum_virials(fluid_pairs, at, begin, end, virials.data());
        for (std::size_t i = begin; i < end; ++i) {
            std::array<Scalar, 6>& v = virials[i - begin];
            const bool touching = touches(solids.pairs, i), strained = moved_[i] != 0 && fluid.pressure[i] > 0;
            const Vec4 normal = strained ? add_samples(solids, i, at[i], samples_per_volume, v) : Vec4(Vec4::Zero());
            const Scalar factor = touching && !strained ? Scalar(0) : to_stress;
            const Scalar mean = trace_share * (v[0] + v[1] + v[2]);
            raw_at[i] = fluid.position[i];
            raw_at[i][3] = factor * (v[0] - mean);
            raw_rest[i] = factor * Vec4(settings.dimensions == 2 ? v[1] : v[1] - mean, v[3], v[4], v[5]);
            if (strained)
                keep_across(normal, settings.dimensions, static_cast<Scalar>(moved_[i]) / kWhole, raw_at[i][3],
                            raw_rest[i]);
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
            const Scalar moved = static_cast<Scalar>(moved_[i]) / kWhole;
            if (moved > 0) {
                Scalar xx = 0;
                Vec4 others;
                mean_of_touching(fluid_pairs, solids.pairs, raw_at, raw_rest, i, xx, others);
                at[i][3] = xx + (Scalar(1) - moved) * at[i][3];
                rest[i] = others + (Scalar(1) - moved) * rest[i];
            }
            const Scalar most = (kMost + moved * (kMostAtBodies - kMost)) * fluid.pressure[i];
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
    push_samples(fluid, solids, at, rest, factor, rho0, workers, velocity, owner_impulses);
}

void PackingStress::push_samples(const FluidState& fluid, const TouchedSolids& solids, std::span<const Vec4> at,
                                 std::span<const Vec4> rest, Scalar factor, double rest_density, const Workers& workers,
                                 std::span<Vec4> velocity, std::span<Wrench> owner_impulses)
{
    const Scalar sample_factor =
        static_cast<Scalar>(2.0 * kParticlesPerSample * rest_density / fluid.particle_mass) * factor;
    for (std::size_t owner = 0; owner < solids.moving.size(); ++owner) {
        if (!(solids.moving[owner] > 0)) continue;
        const std::size_t first = solids.contacts.start[owner];
        const std::size_t rows = solids.contacts.start[owner + 1] - first;
        // One row for each particle that touches the owner.
        owner_impulses[owner] += workers.ordered_sum<Wrench>(rows, reactions_, [&](std::size_t row) {
            const std::size_t i = solids.contacts.particle[first + row];
            Wrench reaction;
            for (std::uint32_t k = solids.pairs.start[i]; k < solids.pairs.start[i + 1]; ++k) {
                const std::uint32_t b = solids.pairs.index[k];
                if (solids.boundary.owner[b] != static_cast<std::int32_t>(owner)) continue;
                const Vec4 x = fluid.position[i] - solids.boundary.position[b];
                const Scalar length_sq = x.squaredNorm();
                if (!(length_sq > 0)) continue;
                const Vec4 part = (sample_factor * solids.moving[owner] * solids.boundary.volume[b] *
                                   solids.pairs.slope[k] * along(x, at[i][3], rest[i]) / length_sq) *
                                  x;
                velocity[i] += part;
                const Vec3d impulse = -fluid.particle_mass * part.head<3>().cast<double>();
                const Vec3d arm = solids.boundary.position[b].head<3>().cast<double>() - solids.centers[owner];
                reaction += {impulse, arm.cross(impulse)};
            }
            return reaction;
        });
    }
}

} // namespace flotsam
