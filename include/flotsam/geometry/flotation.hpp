#pragma once

#include "flotsam/geometry/hydrostatics.hpp"

#include <optional>
#include <span>
#include <vector>

namespace flotsam {

/// A rigid body in still water, with nothing but gravity and buoyancy on it. Water fills every hole of the mesh up to
/// its level: no air is shut in, unless the mesh is an outer_surface.
struct FloatingBody {
    TriangleMesh mesh;                    ///< closed, normals outward [m]
    double mass = 0.0;                    ///< [kg], > 0
    Vec3d center_of_mass = Vec3d::Zero(); ///< [m], mesh frame
    double water_density = 1000.0;        ///< [kg/m^3], > 0
    double gravity = 9.81;                ///< [m/s^2], > 0
};

/// How a body's righting arm grows as it turns from an attitude, its displacement kept [m]: GM = BM - BG with
/// BM = I / V of the waterplane's second moment I about its centroid, and BG = z_G - z_B. Where centre of mass and
/// centre of buoyancy stand above each other the body is stable if both principal heights are positive.
struct MetacentricHeights {
    double heel = 0.0;       ///< about world x [m]: the second moment is that of y^2
    double trim = 0.0;       ///< about world y [m]
    double least = 0.0;      ///< about that principal axis of the waterplane about which it turns most easily [m]
    double greatest = 0.0;   ///< about the other [m]
    double least_axis = 0.0; ///< angle of the axis of `least` from world x, [0, pi) [rad]
};

/// A body at vertical equilibrium in an attitude that is held.
struct Flotation {
    Pose pose;                            ///< puts the water at z = 0 and the centre of mass at x = y = 0
    double draft = 0.0;                   ///< of its lowest point below the water [m]
    Submerged submerged;                  ///< world frame of `pose`
    Waterplane plane;                     ///< likewise
    Vec3d center_of_mass = Vec3d::Zero(); ///< likewise [m]
    MetacentricHeights metacentric_heights;
    Eigen::Vector2d righting_arms = Eigen::Vector2d::Zero(); ///< dE / d(turn about world x, y) / (m g) [m]
    double energy = 0.0;                                     ///< E = m g (z_G - z_B) [J]
};

/// Where the body floats in an attitude that is held; nothing if it is heavier than the water that its whole volume
/// displaces: it sinks.
///
/// The potential energy of body and water at constant displacement is E = m g (z_G - z_B), up to a constant. Its
/// derivatives by small turns a, b about world x and y are exact:
///     dE = m g [(y_G - y_B) a - (x_G - x_B) b],      d^2E = m g ([I_yy, -I_xy; -I_xy, I_xx] / V - BG 1)
/// **Source:** Bouguer 1746 for BM; Gilbert 1991, "How things float", American Mathematical Monthly 98, for E.
/// Throws std::invalid_argument for an empty mesh or one without volume, and for a mass, water density or gravity that
/// is not > 0 and finite, or a centre of mass that is not finite.
[[nodiscard]] std::optional<Flotation> flotation(const FloatingBody& body, const Quatd& orientation);

/// One point of a curve of righting arms.
struct RightingArm {
    double heel = 0.0;   ///< about world x from upright [rad]
    double arm = 0.0;    ///< GZ [m]
    double moment = 0.0; ///< m g GZ [N m]
    double draft = 0.0;  ///< [m]
    double energy = 0.0; ///< E [J]
};

/// Righting arms GZ = y_G - y_B of a body that is turned by each heel angle [rad] about world x from `upright`, held
/// against trim, and left free to rise and sink. For a positive heel GZ is positive where the water turns the body
/// back. m g GZ = dE / d(heel), so the water's moment about x is -m g GZ and its work over a whole turn is zero. Throws
/// std::invalid_argument as flotation does, for angles that are not finite, and for a body that sinks.
[[nodiscard]] std::vector<RightingArm> righting_arms(const FloatingBody& body, const Quatd& upright,
                                                     std::span<const double> heel_angles);

} // namespace flotsam
