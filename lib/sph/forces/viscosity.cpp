#include "sph/forces/viscosity.hpp"

#include "sph/forces/velocity_gradient.hpp"
#include "sph/simd/pair_sums.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

using Mat3 = Eigen::Matrix<Scalar, 3, 3>;

Scalar softening_sq(const ViscositySettings& settings)
{
    return static_cast<Scalar>(0.04 * settings.spacing * settings.spacing); // 0.01 h^2
}

/// Copies of positions and velocities, with half of each particle's strain rate in their fourth components and in
/// `strain` (ViscousPull says how).
void find_strains(const ViscositySettings& settings, const FluidState& fluid, const SelfPairs& pairs,
                  const Workers& workers, std::span<Vec4> position, std::span<Vec4> velocity, std::span<Vec4> strain)
{
    const Scalar volume = static_cast<Scalar>(fluid.particle_mass / settings.rest_density);
    workers.for_chunks(fluid.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        std::array<simd::LinearFit, Workers::kChunk> fits;
        simd::fit_linear(pairs, fluid.position, fluid.velocity, begin, end, fits.data());
        for (std::size_t i = begin; i < end; ++i) {
            const Mat3 half = Scalar(0.5) * velocity_gradient(fits[i - begin], volume, settings.dimensions);
            position[i] = fluid.position[i];
            velocity[i] = fluid.velocity[i];
            position[i][3] = half(0, 0);
            velocity[i][3] = half(1, 1);
            strain[i] << half(2, 2), Scalar(0.5) * (half(0, 1) + half(1, 0)), Scalar(0.5) * (half(0, 2) + half(2, 0)),
                Scalar(0.5) * (half(1, 2) + half(2, 1));
        }
    });
}

void add_between_particles(const ViscositySettings& settings, double dt, const FluidState& fluid,
                           const SelfPairs& pairs, const Workers& workers, const ForceScratch& scratch,
                           std::span<Vec4> velocity)
{
    const Scalar factor =
        static_cast<Scalar>(2.0 * (settings.dimensions + 2) * dt * fluid.particle_mass / settings.rest_density);
    simd::ViscousPull pull;
    pull.viscosity = static_cast<Scalar>(settings.kinematic_viscosity);
    pull.width = static_cast<Scalar>(settings.dissipation * settings.spacing);
    pull.softening_sq = softening_sq(settings);
    // An explicit step is stable below about d^2 / (10 dt); half of it is kept.
    pull.most = static_cast<Scalar>(0.05 * settings.spacing * settings.spacing / dt);
    const bool dissipates = pull.width > Scalar(0);
    for (std::vector<Vec4>* values : scratch) values->resize(fluid.size());
    std::vector<Vec4>&at = *scratch[0], &fast = *scratch[1], &strain = *scratch[2], &change = *scratch[3];
    if (dissipates) find_strains(settings, fluid, pairs, workers, at, fast, strain);
    workers.for_chunks(fluid.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_viscous_pulls(pairs, dissipates ? at : fluid.position, dissipates ? fast : fluid.velocity, strain,
                                pull, begin, end, change);
        for (std::size_t i = begin; i < end; ++i) velocity[i] += factor * change[i];
    });
}

} // namespace

void Viscosity::add(const ViscositySettings& settings, double dt, const FluidState& fluid,
                    const BoundaryState& boundary, const SelfPairs& fluid_pairs, const Pairs& boundary_pairs,
                    std::span<const Vec3d> centers, const Workers& workers, const ForceScratch& scratch,
                    std::span<Vec4> velocity, std::span<Wrench> owner_impulses)
{
    add_between_particles(settings, dt, fluid, fluid_pairs, workers, scratch, velocity);
    if (settings.kinematic_viscosity > 0.0) {
        add_at_boundaries(settings, dt, fluid, boundary, boundary_pairs, centers, workers, velocity, owner_impulses);
    }
}

void Viscosity::add_at_boundaries(const ViscositySettings& settings, double dt, const FluidState& fluid,
                                  const BoundaryState& boundary, const Pairs& pairs, std::span<const Vec3d> centers,
                                  const Workers& workers, std::span<Vec4> velocity, std::span<Wrench> owner_impulses)
{
    const Scalar factor = static_cast<Scalar>(2.0 * (settings.dimensions + 2) * settings.kinematic_viscosity * dt);
    const Scalar soft = softening_sq(settings);
    const std::size_t chunks = Workers::chunk_count(fluid.size());
    reactions_.resize(std::max(reactions_.size(), chunks));
    workers.for_chunks(fluid.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<Reaction>& reactions = reactions_[chunk];
        reactions.clear();
        if (reactions.capacity() == 0) reactions.reserve(16); // owners that the particles of a chunk touch
        for (std::size_t i = begin; i < end; ++i) {
            Vec4 change = Vec4::Zero();
            std::int32_t owner = -1; // of the samples under way, of which a particle's are mostly
            Vec3 center = Vec3::Zero(), pushed = Vec3::Zero(), turned = Vec3::Zero();
            const auto hand_over = [&] {
                if (owner < 0) return;
                auto reaction = std::find_if(reactions.begin(), reactions.end(),
                                             [&](const Reaction& r) { return r.owner == owner; });
                if (reaction == reactions.end()) reaction = reactions.insert(reaction, {owner, {}});
                reaction->impulse +=
                    {-fluid.particle_mass * pushed.cast<double>(), -fluid.particle_mass * turned.cast<double>()};
                pushed = turned = Vec3::Zero();
            };
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
                const std::uint32_t b = pairs.index[k];
                const Vec4 x = fluid.position[i] - boundary.position[b];
                const Scalar pull = x.dot(fluid.velocity[i] - boundary.velocity[b]) / (x.squaredNorm() + soft);
                const Vec4 part = (factor * boundary.volume[b] * pull * pairs.slope[k]) * x;
                change += part;
                if (boundary.owner[b] != owner) {
                    hand_over();
                    owner = boundary.owner[b];
                    center = centers[static_cast<std::size_t>(owner)].cast<Scalar>();
                }
                pushed += part.head<3>();
                turned += Vec3(boundary.position[b].head<3>() - center).cross(Vec3(part.head<3>()));
            }
            hand_over();
            velocity[i] += change;
        }
    });
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (const Reaction& r : reactions_[chunk]) owner_impulses[static_cast<std::size_t>(r.owner)] += r.impulse;
    }
}

} // namespace flotsam
