#include "sph/forces/dissipation.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace flotsam {

using Mat3 = Eigen::Matrix<Scalar, 3, 3>;

void Dissipation::velocity_gradients(int dimensions, const FluidState& fluid, const Pairs& pairs,
                                     const Workers& workers)
{
    gradient_.resize(fluid.size());
    const Scalar mass = static_cast<Scalar>(fluid.particle_mass);
    workers.for_each(fluid.size(), [&](std::size_t i) {
        Mat3 slope = Mat3::Zero(), shape = Mat3::Zero();
        for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
            const std::uint32_t j = pairs.index[k];
            const Vec3 weight = mass / fluid.density[j] * pairs.gradient[k].head<3>();
            slope += (fluid.velocity[j] - fluid.velocity[i]).head<3>() * weight.transpose();
            shape += (fluid.position[j] - fluid.position[i]).head<3>() * weight.transpose();
        }
        if (dimensions == 2) shape(1, 1) = 1;
        // `shape` is the identity in a full neighbourhood; where it is nearly singular (spray) there is no linear field.
        const Scalar determinant = shape.determinant();
        gradient_[i] = determinant > Scalar(0.05) ? Mat3(slope * shape.inverse()) : Mat3::Zero();
    });
}

void Dissipation::add(double strength, double dt, int dimensions, double spacing, const FluidState& fluid,
                      const Pairs& pairs, const Workers& workers, std::span<Vec4> velocity)
{
    velocity_gradients(dimensions, fluid, pairs, workers);
    const Scalar mass = static_cast<Scalar>(fluid.particle_mass);
    const Scalar softening = static_cast<Scalar>(0.04 * spacing * spacing);
    const Scalar factor = static_cast<Scalar>(2.0 * (dimensions + 2) * dt);
    const Scalar width = static_cast<Scalar>(strength * spacing);
    // An explicit step is stable below about d^2 / (10 dt).
    const Scalar most = static_cast<Scalar>(0.05 * spacing * spacing / dt);
    workers.for_each(fluid.size(), [&](std::size_t i) {
        Vec4 change = Vec4::Zero();
        for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
            const std::uint32_t j = pairs.index[k];
            const Vec3 x = (fluid.position[i] - fluid.position[j]).head<3>();
            const Scalar raw = (fluid.velocity[i] - fluid.velocity[j]).head<3>().dot(x);
            const Scalar linear = Scalar(0.5) * x.dot((gradient_[i] + gradient_[j]) * x);
            const Scalar rest = raw - linear;
            const Scalar q = raw > Scalar(0) ? std::clamp(rest, Scalar(0), raw) : std::clamp(rest, raw, Scalar(0));
            const Scalar distance_sq = x.squaredNorm() + softening;
            const Scalar nu = std::min(most, width * std::abs(q) / std::sqrt(distance_sq));
            change += (Scalar(2) * mass / (fluid.density[i] + fluid.density[j]) * nu * q / distance_sq) *
                      pairs.gradient[k];
        }
        change[3] = 0;
        velocity[i] += factor * change;
    });
}

} // namespace flotsam
