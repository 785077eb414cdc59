#include "geometry/sample_rods.hpp"

#include "geometry/point_grid.hpp"

#include <algorithm>

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
    // At an ordinary convex corner the next sample of the layer is at most sqrt(3) insets and a hole away.
    const double far = 1.1 * spacing + 1.8 * offset.inset(), apart = 0.8 * spacing;
    const auto thick_end = std::partition(samples.begin(), samples.end(), [](const OffsetPoint& p) { return !p.thin; });
    const auto first_thin = thick_end - samples.begin();
    const PointGrid thick(positions_of({samples.data(), static_cast<std::size_t>(first_thin)}), far);
    const auto covered = [&](const Vec3d& p) {
        const auto near = [&](const OffsetPoint& sample) { return (sample.position - p).norm() < apart; };
        return std::any_of(samples.begin() + first_thin, samples.end(), near);
    };
    for (const BarePoint& point : bare) {
        if (thick.nearest(point.base, far) < far || covered(point.base)) continue;
        const OffsetPoint deepest = offset.deepest_below(point.base, point.inward);
        if (thick.nearest(deepest.position, apart) >= apart && !covered(deepest.position)) samples.push_back(deepest);
    }
}

} // namespace flotsam
