#pragma once

#include "flotsam/geometry/hydrostatics.hpp"
#include "flotsam/geometry/surface_query.hpp"

#include <optional>
#include <vector>

namespace flotsam {

/// Tells what lies in the basins that a vessel has in water up to a level.
class BasinQuery {
  public:
    BasinQuery(const TriangleMesh& closed, const Pose& pose, double water_level);

    [[nodiscard]] bool empty() const { return !surface_; } ///< she has none
    /// Whether a basin is straight below the point, and nothing else in between, and the point below the highest of
    /// the mesh. What lies on the surface, within `slack` [m], is in a basin if that is the basin's.
    [[nodiscard]] bool holds(const Vec3d& point, double slack = 0.0) const;

  private:
    std::vector<char> is_basin_;
    std::optional<SurfaceQuery> surface_; ///< in the world
};

/// The mesh as hydrostatics of vessels want it: itself, in two dimensions its outline in the plane y = 0 pulled along y
/// by a metre, without ends, which would join the inside of a vessel with her outside.
[[nodiscard]] TriangleMesh hull_of(const TriangleMesh& closed, int dimensions);

} // namespace flotsam
