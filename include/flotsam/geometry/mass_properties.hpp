#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

namespace flotsam {

/// Of a solid of density 1 kg/m^3.
struct MassProperties {
    double volume = 0.0;                  ///< [m^3]
    Vec3d center_of_mass = Vec3d::Zero(); ///< [m], mesh frame
    Mat3d inertia = Mat3d::Zero();        ///< about the centre of mass, mesh axes [kg m^2 per kg/m^3]
};

/// Volume, centre of mass and inertia of a closed mesh by the divergence theorem, summed about its bounds' centre.
/// **Source:** Eberly 2002, "Polyhedral mass properties (revisited)".
[[nodiscard]] MassProperties mass_properties(const TriangleMesh& mesh);

} // namespace flotsam
