#include "sph/forces/viscosity.hpp"

#include <algorithm>

namespace flotsam {

void Viscosity::add(double kinematic_viscosity, double dt, int dimensions, double support, const FluidState& fluid,
                    const BoundaryState& boundary, const Pairs& fluid_pairs, const Pairs& boundary_pairs,
                    std::span<const Vec3d> centers, const Workers& workers, std::span<Vec4> velocity,
                    std::span<Wrench> owner_impulses)
{
    const Scalar factor = static_cast<Scalar>(2.0 * (dimensions + 2) * kinematic_viscosity * dt);
    const Scalar softening = static_cast<Scalar>(0.01 * support * support);
    const Scalar mass = static_cast<Scalar>(fluid.particle_mass);
    const auto pull = [&](const Vec4& offset, const Vec4& relative_velocity) {
        const Vec3 x = offset.head<3>();
        return x.dot(relative_velocity.head<3>()) / (x.squaredNorm() + softening);
    };
    const std::size_t chunks = Workers::chunk_count(fluid.size());
    reactions_.resize(std::max(reactions_.size(), chunks));
    workers.for_chunks(fluid.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<Reaction>& reactions = reactions_[chunk];
        reactions.clear();
        for (std::size_t i = begin; i < end; ++i) {
            Vec4 change = Vec4::Zero();
            for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k) {
                const std::uint32_t j = fluid_pairs.index[k];
                // The mean density keeps the pair force symmetric, and with it momentum.
                const Scalar weight = Scalar(2) * mass / (fluid.density[i] + fluid.density[j]);
                change += weight * pull(fluid.position[i] - fluid.position[j], fluid.velocity[i] - fluid.velocity[j]) *
                          fluid_pairs.gradient[k];
            }
            for (std::uint32_t k = boundary_pairs.start[i]; k < boundary_pairs.start[i + 1]; ++k) {
                const std::uint32_t b = boundary_pairs.index[k];
                const Vec4 part =
                    boundary.position[b][3] *
                    pull(fluid.position[i] - boundary.position[b], fluid.velocity[i] - boundary.velocity[b]) *
                    boundary_pairs.gradient[k];
                change += part;
                const std::int32_t owner = boundary.owner[b];
                if (reactions.empty() || reactions.back().owner != owner) reactions.push_back({owner, {}});
                const Vec3d impulse = -(mass * factor * part).head<3>().cast<double>();
                const Vec3d arm =
                    boundary.position[b].head<3>().cast<double>() - centers[static_cast<std::size_t>(owner)];
                reactions.back().impulse += {impulse, arm.cross(impulse)};
            }
            change[3] = 0;
            velocity[i] += factor * change;
        }
    });
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (const Reaction& r : reactions_[chunk]) owner_impulses[static_cast<std::size_t>(r.owner)] += r.impulse;
    }
}

} // namespace flotsam
