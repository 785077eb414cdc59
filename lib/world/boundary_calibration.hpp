#pragma once

#include "flotsam/core/types.hpp"
#include "flotsam/sph/kernel.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Where samples lie and how much they count, once for each kernel and blue-noise samples.
struct BoundaryCalibration {
    double inset;  ///< depth of the samples below the true surface, in spacings
    double volume; ///< V_b = volume / sum_b' W_bb'; of bodies, what fit_volumes starts with
    double solid;  ///< density of bodies in fit_volumes
};

/// The constants for a kernel in 2 or 3 dimensions, found on settled water: level and pressure of a still tank and the
/// force on bodies held under water (tests/validation); no other constant depends on the scene.
[[nodiscard]] BoundaryCalibration boundary_calibration(KernelKind kernel, int dimensions);

/// V_b of each sample [m^3]: factor / sum of the kernel over the samples of the same surface (itself included).
/// The factor is the calibrated one at the calibrated depth. Samples in the middle of a thin solid lie less deep;
/// theirs is such that water half a spacing in front of the surface sees the same density: the kernel's integral over a
/// plane at half a spacing plus the depth, times the factor, is constant.
/// **Source:** Akinci et al. 2012, eq. 4. **Differs:** by the factor.
[[nodiscard]] std::vector<double> sample_volumes(std::span<const Vec3d> positions, std::span<const double> depths,
                                                 KernelKind kernel, double particle_spacing, int dimensions);

/// How much of the samples of a sheet water beyond its rim feels: the two layers stand for the half spaces behind two
/// faces, and beyond the rim for what is between these, of the sheet's thickness [m].
[[nodiscard]] double rim_weight(double thickness, KernelKind kernel, double particle_spacing, int dimensions);

} // namespace flotsam
