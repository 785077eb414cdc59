#include "geometry/sample_rods.hpp"

#include "geometry/point_grid.hpp"

namespace flotsam {

std::vector<Vec3d> positions_of(std::span<const OffsetPoint> points)
{
    std::vector<Vec3d> positions;
    positions.reserve(points.size());
    for (const OffsetPoint& point : points) positions.push_back(point.position);
    return positions;
}

void sample_rods(std::vector<OffsetPoint>& samples, std::span<const BarePoint> bare, const OffsetSurface& offset,
                 double spacing)
{
    // At an ordinary convex corner the next sample is at most sqrt(3) insets and a hole away.
    const double far = 1.1 * spacing + 1.8 * offset.inset(), apart = 0.9 * spacing;
    PointGrid grid(positions_of(samples), far);
    for (const BarePoint& point : bare) {
        if (grid.nearest(point.base, far) < far) continue;
        const OffsetPoint deepest = offset.deepest_below(point.base, point.inward);
        if (grid.nearest(deepest.position, apart) < apart) continue;
        samples.push_back(deepest);
        grid = PointGrid(positions_of(samples), far);
    }
}

} // namespace flotsam
