#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace flotsam {

/// Eigenvalues of a symmetric 2x2 matrix, the smaller one first, with their unit vectors.
struct PrincipalAxes {
    std::array<double, 2> values;
    std::array<Eigen::Vector2d, 2> axes;
};

[[nodiscard]] inline PrincipalAxes principal_axes(const Eigen::Matrix2d& symmetric)
{
    const double mean = 0.5 * (symmetric(0, 0) + symmetric(1, 1));
    const double half = 0.5 * (symmetric(0, 0) - symmetric(1, 1));
    const double radius = std::hypot(half, symmetric(0, 1));
    const double angle = 0.5 * std::atan2(symmetric(0, 1), half); // of the greater one's axis
    const Eigen::Vector2d greater(std::cos(angle), std::sin(angle));
    return {{mean - radius, mean + radius}, {Eigen::Vector2d(-greater.y(), greater.x()), greater}};
}

} // namespace flotsam
