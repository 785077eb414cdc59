#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/geometry/surface_query.hpp"

#include <vector>

namespace flotsam {

/// A lower bound of the distance to a surface, cheap everywhere: exact distances at the nodes of a grid near the
/// surface, and what follows from them between: distance(x) >= distance(node) - |x - node|.
class DistanceBounds {
  public:
    /// `spacing` of the nodes and `band` around the surface in which they are exact [m].
    DistanceBounds(const SurfaceQuery& surface, double spacing, double band, const Workers& workers);

    [[nodiscard]] double at(const Vec3d& point) const;
    /// The same from the nearest node alone: a lower bound that takes an eighth of the time.
    [[nodiscard]] double rough_at(const Vec3d& point) const;

  private:
    [[nodiscard]] std::size_t index(int x, int y, int z) const
    {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(nodes_.x()) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(nodes_.y()) * static_cast<std::size_t>(z));
    }

    Vec3d origin_;
    double spacing_, band_;
    Eigen::Vector3i nodes_;
    std::vector<float> distance_;
};

} // namespace flotsam
