#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/geometry/surface_query.hpp"
#include "flotsam/sph/kernel.hpp"

#include <span>
#include <vector>

namespace flotsam {

struct VolumeFit {
    KernelKind kernel = KernelKind::quintic;
    int dimensions = 3;
    double particle_spacing = 0.0; ///< d [m]
    double density = 1.0;          ///< of the solid as water sees it; 1: as much as water in its place
};

/// Changes the volumes of a solid's samples, all that it has, so that water sees an edge as an edge.
///
/// Volumes by the spacing of the samples alone make faces right, but a layer below an edge stands for only half of what
/// the edge holds: water cuts corners, and a body of eight spacings displaces 2 % less than its volume, one of four 6
/// %. Here each point y half a spacing in front of the surface is to see
///
///     sum_b V_b W(y - x_b) = density * integral of W(y - z) dz over the solid,
///
/// which five rounds of V_b <- V_b (sum_y W want / have) / (sum_y W) come close to (the least Kullback-Leibler
/// divergence, if they went on). The integral is that of a field over the surface: the field F(r) = (I(r) - c) r /
/// r^dim, I(r) = integral of W s^(dim-1) ds from 0 to r, c its value beyond the support, has the divergence W away from
/// r = 0, and none of it beyond the support.
///
/// Volumes change by a factor of three at most. In two dimensions the solid is the mesh's cut with the plane y = 0.
/// **Source:** Richardson 1972, Lucy 1974 for the rounds.
void fit_volumes(const SurfaceQuery& solid, const VolumeFit& fit, std::span<const Vec3d> positions,
                 std::span<double> volumes, const Workers& workers);

} // namespace flotsam
