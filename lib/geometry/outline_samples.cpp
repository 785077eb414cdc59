#include "geometry/outline_samples.hpp"
namespace flotsam {
std::vector<OffsetPoint> sample_outline(const SurfaceQuery&, const SurfaceSampleSettings&)
{
    return {};
}
} // namespace flotsam
