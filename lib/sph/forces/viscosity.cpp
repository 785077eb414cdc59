#include "sph/forces/viscosity.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

Scalar softening_sq(const ViscositySettings& settings)
{
    return static_cast<Scalar>(0.04 * settings.spacing * settings.spacing); // 0.01 h^2
}

} // namespace

void Viscosity::add(const ViscositySettings& settings, double dt, const FluidState& fluid,
                    const BoundaryState& boundary, const Pairs& fluid_pairs, const Pairs& boundary_pairs,
                    std::span<const Vec3d> centers, const Workers& workers, std::span<Vec4> velocity,
                    std::span<Wrench> owner_impulses)
{
    find_gradients(settings, fluid, fluid_pairs, workers);
    add_between_particles(settings, dt, fluid, fluid_pairs, workers, velocity);
    if (settings.kinematic_viscosity > 0.0) {
        add_at_boundaries(settings, dt, fluid, boundary, boundary_pairs, centers, workers, velocity, owner_impulses);
    }
}

void Viscosity::find_gradients(const ViscositySettings& settings, const FluidState& fluid, const Pairs& pairs,
                               const Workers& workers)
{
    gradient_.resize(settings.dissipation > 0.0 ? fluid.size() : 0);
    const Scalar volume = static_cast<Scalar>(fluid.particle_mass / settings.rest_density);
    workers.for_each(gradient_.size(), [&](std::size_t i) {
        Columns slope, shape;
        slope.fill(Vec4::Zero());
        shape.fill(Vec4::Zero());
        const Vec4 x = fluid.position[i], v = fluid.velocity[i];
        for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
            const Vec4 dx = fluid.position[pairs.index[k]] - x, dv = fluid.velocity[pairs.index[k]] - v;
            const Vec4 weight = pairs.gradient[k];
            for (std::size_t c = 0; c < 3; ++c) {
                slope[c] += weight[static_cast<int>(c)] * dv;
                shape[c] += weight[static_cast<int>(c)] * dx;
            }
        }
        Eigen::Matrix<Scalar, 3, 3> shape3, slope3;
        for (int c = 0; c < 3; ++c) {
            shape3.col(c) = volume * shape[static_cast<std::size_t>(c)].head<3>();
            slope3.col(c) = Scalar(0.5) * volume * slope[static_cast<std::size_t>(c)].head<3>();
        }
        if (settings.dimensions == 2) shape3(1, 1) = 1;
        // The shape is the identity in a full neighbourhood; where it is nearly singular (spray) there is no linear
        // field.
        const bool full = shape3.determinant() > Scalar(0.05);
        if (full) slope3 = (slope3 * shape3.inverse()).eval();
        for (int c = 0; c < 3; ++c) {
            Vec4 column = Vec4::Zero();
            if (full) column.head<3>() = slope3.col(c);
            gradient_[i][static_cast<std::size_t>(c)] = column;
        }
    });
}

void Viscosity::add_between_particles(const ViscositySettings& settings, double dt, const FluidState& fluid,
                                      const Pairs& pairs, const Workers& workers, std::span<Vec4> velocity) const
{
    const Scalar factor =
        static_cast<Scalar>(2.0 * (settings.dimensions + 2) * dt * fluid.particle_mass / settings.rest_density);
    const Scalar nu = static_cast<Scalar>(settings.kinematic_viscosity);
    const Scalar width = static_cast<Scalar>(settings.dissipation * settings.spacing);
    const Scalar soft = softening_sq(settings);
    // An explicit step is stable below about d^2 / (10 dt); half of it is kept.
    const Scalar most = static_cast<Scalar>(0.05 * settings.spacing * settings.spacing / dt);
    const bool dissipates = !gradient_.empty();
    workers.for_each(fluid.size(), [&](std::size_t i) {
        Vec4 change = Vec4::Zero();
        const Vec4 own_x = fluid.position[i], own_v = fluid.velocity[i];
        for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
            const std::uint32_t j = pairs.index[k];
            const Vec4 x = own_x - fluid.position[j];
            const Scalar s = x.dot(own_v - fluid.velocity[j]);
            const Scalar distance_sq = x.squaredNorm() + soft;
            Scalar pull = nu * s;
            if (dissipates) {
                const Columns &a = gradient_[i], &b = gradient_[j];
                const Vec4 linear = x[0] * (a[0] + b[0]) + x[1] * (a[1] + b[1]) + x[2] * (a[2] + b[2]);
                const Scalar rest = s - x.dot(linear);
                const Scalar q = std::clamp(rest, std::min(s, Scalar(0)), std::max(s, Scalar(0)));
                pull += std::min(most, width * std::abs(q) / std::sqrt(distance_sq)) * q;
            }
            change += (pull / distance_sq) * pairs.gradient[k];
        }
        change[3] = 0;
        velocity[i] += factor * change;
    });
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
            for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
                const std::uint32_t b = pairs.index[k];
                const Vec4 x = fluid.position[i] - boundary.position[b];
                const Scalar pull = x.dot(fluid.velocity[i] - boundary.velocity[b]) / (x.squaredNorm() + soft);
                Vec4 part = factor * boundary.volume[b] * pull * pairs.gradient[k];
                part[3] = 0;
                change += part;
                const std::int32_t owner = boundary.owner[b];
                auto reaction = std::find_if(reactions.begin(), reactions.end(),
                                             [&](const Reaction& r) { return r.owner == owner; });
                if (reaction == reactions.end()) reaction = reactions.insert(reaction, {owner, {}});
                const Vec3d impulse = -fluid.particle_mass * part.head<3>().cast<double>();
                const Vec3d arm =
                    boundary.position[b].head<3>().cast<double>() - centers[static_cast<std::size_t>(owner)];
                reaction->impulse += {impulse, arm.cross(impulse)};
            }
            velocity[i] += change;
        }
    });
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (const Reaction& r : reactions_[chunk]) owner_impulses[static_cast<std::size_t>(r.owner)] += r.impulse;
    }
}

} // namespace flotsam
