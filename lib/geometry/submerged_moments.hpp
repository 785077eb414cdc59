#pragma once

#include "flotsam/geometry/hydrostatics.hpp"

namespace flotsam {

/// Moments of what lies below the water and of the waterplane, about an origin in the water plane that lies above or
/// below the pose's position.
struct SubmergedMoments {
    double volume = 0.0;                                          ///< [m^3]
    Vec3d moment = Vec3d::Zero();                                 ///< integral of x over the volume [m^4]
    double area = 0.0;                                            ///< of the waterplane [m^2]
    Eigen::Vector2d area_moment = Eigen::Vector2d::Zero();        ///< integral of (x, y) over it [m^3]
    Eigen::Matrix2d area_second_moment = Eigen::Matrix2d::Zero(); ///< of (x, y)(x, y)^T [m^4]
    double shadow = 0.0; ///< what the wetted triangles cover when projected one by one [m^2]: the scale of rounding
};

/// Exact for a closed mesh. A face that lies in the plane counts as above it.
[[nodiscard]] SubmergedMoments submerged_moments(const TriangleMesh& closed, const Pose& pose, double water_level);

/// The same as a waterplane in the world; zeros where its area is no more than rounding.
[[nodiscard]] Waterplane waterplane_of(const SubmergedMoments& sum, const Pose& pose);

/// Lowest and highest vertex in the world [m].
struct HeightRange {
    double low;
    double high;
};
[[nodiscard]] HeightRange height_range(const TriangleMesh& mesh, const Pose& pose);

/// The water level [m] within `range`, the mesh's own, at which it displaces `displaced_volume` [m^3], more than 0 and
/// less than all of it. `guess` is where to begin: near the answer it takes three or four cuts of the mesh.
[[nodiscard]] double level_of_volume(const TriangleMesh& closed, const Pose& pose, double displaced_volume,
                                     const HeightRange& range, double guess);

} // namespace flotsam
