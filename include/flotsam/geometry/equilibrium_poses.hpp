#pragma once

#include "flotsam/geometry/flotation.hpp"

#include <optional>
#include <stdexcept>
#include <vector>

namespace flotsam {

/// A pose in which a free body stays afloat.
struct EquilibriumPose {
    Flotation flotation;
    double heel_deg = 0.0;              ///< turn about the body's x axis, (-180, 180]; any where that axis is upright
    double trim_deg = 0.0;              ///< inclination of the body's x axis, [-90, 90]; positive: its +x end is down
    Vec3d rotation_deg = Vec3d::Zero(); ///< the orientation as a rotation vector in degrees
    /// In how many directions the body lies where it is put: 0 stable in both axes, 1 a cylinder that lies
    /// or floats inclined, 2 a sphere.
    int neutral_directions = 0;
    double residual = 0.0; ///< torque left over m g and the cube root of the mesh's volume [-]
};

/// What stable_poses found.
struct EquilibriumPoses {
    std::vector<EquilibriumPose> poses; ///< by energy, lowest first
    int starts = 0;
    int unconverged_starts = 0; ///< those that did not come to rest
};

/// No descent came to rest; what() says the smallest residual.
class NoEquilibrium : public std::runtime_error {
  public:
    explicit NoEquilibrium(double residual);
    double residual;
};

/// All poses in which a free body floats stably: the local minima of E = m g (z_G - z_B) over the directions that can
/// be up. Nothing if it sinks.
///
/// From each of 162 directions, spread evenly, E is taken downhill in Newton steps with its exact derivatives
/// (flotation.hpp), the eigenvalues of the second one made positive, steps of at most 0.2 rad, each halved until E
/// falls: E has a continuous slope, but its curvature jumps where a face dips in. A saddle is left along its axis of
/// negative metacentric height. Poses within 0.2 degrees are one. A direction is neutral if a turn of 10 degrees to
/// either side lifts E by less than 1e-5 m g times the cube root of the volume, so that the facets of round bodies do
/// not count: a straight turn or, where E is ten times as stiff across as along, one on the floor of the valley, which
/// goes in a ring where a round body floats with its axis inclined. The floor is followed in strides of a degree along
/// the direction in which it led so far, each with Newton steps across. Neutral poses that are joined by a path that
/// neither rises nor falls by more than that are one family, of which the lowest is returned. Paths are sought from
/// pose to pose, the nearest first, and along the valleys. A basin that is narrower than the 16 degrees between starts
/// can be missed. Each pose comes without yaw: orientation = (turn about world y by trim) (turn about world x by heel).
/// Every result repeats bit for bit. Takes about 0.1 ms a triangle.
/// **Source:** Gilbert 1991; starts on a Fibonacci lattice, Swinbank & Purser 2006.
/// Throws NoEquilibrium; std::invalid_argument as flotation does.
[[nodiscard]] std::optional<EquilibriumPoses> stable_poses(const FloatingBody& body);

/// The stable pose that the body comes to when it is let go in `start`, without inertia and without yaw: downhill from
/// there as above. Nothing if it sinks. From an exact balance on a saddle it falls to one side, always the same. Throws
/// NoEquilibrium; std::invalid_argument as flotation does.
[[nodiscard]] std::optional<EquilibriumPose> settled_pose(const FloatingBody& body, const Quatd& start);

} // namespace flotsam
