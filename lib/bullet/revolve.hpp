#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <vector>

namespace flotsam {

/// A point of the outline of a solid of revolution.
struct ProfilePoint {
    double radius; ///< [m]
    double z;      ///< [m]
};

/// Closed mesh of the solid that the profile sweeps about the z axis. The profile goes from the bottom pole to the top
/// pole; only these two points have radius 0. The radii are scaled so that the mesh has exactly `volume` [m^3].
[[nodiscard]] TriangleMesh revolved(const std::vector<ProfilePoint>& profile, int segments, double volume);

} // namespace flotsam
