#include "world/boundary_calibration.hpp"

#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <cmath>
#include <numbers>

namespace flotsam {

BoundaryCalibration boundary_calibration(KernelKind kernel, int dimensions)
{
    // Cubes and balls of 3 to 14 d held under water: 1.000 to 1.007 of the displaced weight (quintic), 0.97 to 1.000
    // (cubic); squares and discs of 4 to 16 d 1.000 to 1.017, in 2-D with 0.01 of noise. Faces alone would have 0.944
    // and 0.876, 0.985 and 0.897 of their density with the volumes that walls have; those of walls are found by the
    // level of a still tank.
    if (kernel == KernelKind::cubic)
        return dimensions == 3 ? BoundaryCalibration{0.6, 1.1, 0.88} : BoundaryCalibration{0.6, 1.05, 0.895};
    return dimensions == 3 ? BoundaryCalibration{0.66, 1.1, 0.90} : BoundaryCalibration{0.66, 1.1, 0.94};
}

namespace {

/// Integral of the kernel over a plane (in 2-D: a line) at distance z [1/m].
double plane_integral(const Kernel& kernel, double z, int dimensions)
{
    constexpr int kSteps = 400;
    const double reach = static_cast<double>(kernel.support());
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) {
        const double r = (k + 0.5) * reach / kSteps;
        const double ring = dimensions == 3 ? 2.0 * std::numbers::pi * r : 2.0;
        sum += ring * static_cast<double>(kernel.value(static_cast<Scalar>(std::hypot(z, r)))) * reach / kSteps;
    }
    return sum;
}

} // namespace

std::vector<double> sample_volumes(std::span<const Vec3d> positions, std::span<const double> depths, KernelKind kind,
                                   double particle_spacing, int dimensions)
{
    const Kernel kernel(kind, particle_spacing, dimensions);
    const double support = static_cast<double>(kernel.support());
    std::vector<Vec4> points(positions.size());
    for (std::size_t b = 0; b < points.size(); ++b) points[b] << positions[b].cast<Scalar>(), Scalar(0);
    const Workers workers(1);
    const CellGrid grid = CellGrid::around(points, {}, support, 8 * points.size() + 4096);
    CellLists lists;
    lists.build(grid, points, workers);
    NeighbourSearch search;
    Pairs pairs;
    kernel.visit([&](const auto& spline) { search.find(spline, grid, lists, points, true, {}, workers, pairs); });
    const BoundaryCalibration calibration = boundary_calibration(kind, dimensions);
    const double water = 0.5 * particle_spacing, full = calibration.inset * particle_spacing;
    const double at_full = plane_integral(kernel, water + full, dimensions);
    std::vector<double> volumes(points.size());
    for (std::size_t b = 0; b < points.size(); ++b) {
        const double sum = static_cast<double>(kernel.value(0)) + static_cast<double>(pairs.kernel_sum[b]);
        // Depths differ by rounding only where the solid is thick.
        const bool thin = depths[b] < 0.999 * full;
        const double factor = thin
                                  ? calibration.volume * at_full / plane_integral(kernel, water + depths[b], dimensions)
                                  : calibration.volume;
        volumes[b] = factor / sum;
    }
    return volumes;
}

double rim_weight(double thickness, KernelKind kind, double particle_spacing, int dimensions)
{
    // Samples of one layer stand for factor / (integral over their plane) of depth.
    const double layer = boundary_calibration(kind, dimensions).volume /
                         plane_integral(Kernel(kind, particle_spacing, dimensions), 0.0, dimensions);
    return std::min(1.0, thickness / (2.0 * layer));
}

} // namespace flotsam
