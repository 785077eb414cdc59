#pragma once

#include "flotsam/core/types.hpp"
#include "sph/simd/pair_sums.hpp"

#include <Eigen/LU>

namespace flotsam {

/// Of the velocity field that fits a particle's neighbours best, [row][column] dv_row / dx_column [1/s]; zero where the
/// neighbours leave it open (spray). `volume`: of a particle [m^3, m^2 in 2-D].
/// **Source:** Randles & Libersky 1996 (the renormalised gradient).
inline Eigen::Matrix<Scalar, 3, 3> velocity_gradient(const simd::LinearFit& fit, Scalar volume, int dimensions)
{
    using Mat3 = Eigen::Matrix<Scalar, 3, 3>;
    const auto& s = fit.shape;
    Mat3 shape, slope;
    shape << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
    for (int k = 0; k < 9; ++k) slope(k / 3, k % 3) = volume * fit.velocity[static_cast<std::size_t>(k)];
    shape *= volume;
    if (dimensions == 2) shape(1, 1) = 1;
    // The shape is the identity in a full neighbourhood.
    if (!(shape.determinant() > Scalar(0.05))) return Mat3::Zero();
    return slope * shape.inverse();
}

} // namespace flotsam
