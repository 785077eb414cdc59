#include "world/boundary_calibration.hpp"

#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <cstdlib>

namespace flotsam {

BoundaryCalibration boundary_calibration(int dimensions)
{
    BoundaryCalibration c = dimensions == 3 ? BoundaryCalibration{0.95, 6.0} : BoundaryCalibration{0.95, 7.0};
    if (const char* e = std::getenv("FLOTSAM_INSET")) c.inset = std::atof(e);
    if (const char* e = std::getenv("FLOTSAM_VOLUME")) c.volume = std::atof(e);
    return c;
}

std::vector<double> sample_volumes(std::span<const Vec3d> positions, double particle_spacing, int dimensions)
{
    const double support = 2.0 * particle_spacing;
    const CubicSpline kernel(support, dimensions);
    std::vector<Vec4> points(positions.size());
    for (std::size_t b = 0; b < points.size(); ++b) points[b] << positions[b].cast<Scalar>(), Scalar(0);
    const Workers workers(1);
    const CellGrid grid = CellGrid::around(points, {}, support, 8 * points.size() + 4096);
    CellLists lists;
    lists.build(grid, points, workers);
    NeighbourSearch search;
    Pairs pairs;
    search.find(kernel, grid, lists, points, points, true, workers, pairs);
    const double factor = boundary_calibration(dimensions).volume;
    std::vector<double> volumes(points.size());
    for (std::size_t b = 0; b < points.size(); ++b) {
        double sum = static_cast<double>(kernel.value(0));
        for (std::uint32_t k = pairs.start[b]; k < pairs.start[b + 1]; ++k)
            sum += static_cast<double>(pairs.gradient[k][3]);
        volumes[b] = factor / sum;
    }
    return volumes;
}

} // namespace flotsam
