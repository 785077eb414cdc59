#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <optional>
#include <vector>

namespace flotsam {

/// Whether water comes to rest level under `gravity`, as water lines and drafts are measured: it points down the z
/// axis.
[[nodiscard]] inline bool is_level(const Vec3d& gravity)
{
    return gravity.z() < 0.0 && gravity.head<2>().norm() < 1e-6 * gravity.norm();
}

/// The part of a solid that lies below a horizontal water plane.
struct Submerged {
    double volume = 0.0;                      ///< [m^3]
    Vec3d center_of_buoyancy = Vec3d::Zero(); ///< [m], world frame; zero where volume is
    double waterplane_area = 0.0;             ///< [m^2]
};

/// Exact for the closed mesh: each triangle is clipped at the plane z = water_level. `pose` places mesh points in the
/// world. A face that lies in the plane counts as above it.
[[nodiscard]] Submerged submerged_part(const TriangleMesh& closed, const Pose& pose, double water_level);

/// Where the water plane cuts a solid: all its parts (both hulls of a catamaran), holes taken off.
struct Waterplane {
    double area = 0.0;                                       ///< [m^2]
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();      ///< [m], world x and y: the centre of flotation
    Eigen::Matrix2d second_moment = Eigen::Matrix2d::Zero(); ///< of (x, y)(x, y)^T about the centroid, world axes [m^4]
};

/// Exact for the closed mesh, by the divergence theorem on the field f(x, y) e_z: the integral of f over the waterplane
/// is minus that of f n_z over the wetted surface, for f = 1, x, y, x^2, x y, y^2. `pose` places mesh points in the
/// world. A face that lies in the plane counts as above it: the waterplane of a box that the water just covers is its
/// top, that of a box which just touches the water is empty. All zeros where nothing is cut.
[[nodiscard]] Waterplane waterplane(const TriangleMesh& closed, const Pose& pose, double water_level);

/// The part below the water in the plane y = 0, per metre of width: `volume` is the area [m^2] of the solid's cut below
/// the water level, `waterplane_area` the length of the cut's water line [m], the centre has y = 0.
[[nodiscard]] Submerged submerged_section(const TriangleMesh& closed, const Pose& pose, double water_level);

/// Height of the mesh's lowest vertex in the world [m].
[[nodiscard]] double lowest_point(const TriangleMesh& mesh, const Pose& pose);

/// Draft at which the mesh, turned as given, displaces `displaced_volume` [m^3]: how far its lowest point lies
/// below the water [m]. Nothing if it displaces less than that when wholly under water: it sinks.
[[nodiscard]] std::optional<double> equilibrium_draft(const TriangleMesh& closed, const Quatd& orientation,
                                                      double displaced_volume);

/// Triangles of basins: 1 for each of a part of the surface below the water that hangs together with none of what
/// bounds the solid from outside, 0 for others. Water outside does not come to it: the inside of a boat whose rim is
/// above the water, a cavity. `pose` places mesh points in the world.
[[nodiscard]] std::vector<char> basins(const TriangleMesh& closed, const Pose& pose, double water_level);

/// What of a closed mesh water outside can come to: without cavities (parts that face inward, as check_mesh leaves
/// them) and what lies in them.
[[nodiscard]] TriangleMesh outer_surface(const TriangleMesh& closed);

/// As equilibrium_draft, of a vessel whose basins hold nothing but what `displaced_volume` [m^3] counts with her: they
/// displace water, too. `pose` and `water_level` are about where she floats. Nothing if she sinks, or founders, as the
/// water comes over her rim first.
[[nodiscard]] std::optional<double> vessel_draft(const TriangleMesh& closed, const Pose& pose, double water_level,
                                                 double displaced_volume);

} // namespace flotsam
