#pragma once

#include "flotsam/geometry/flotation.hpp"
#include "geometry/submerged_moments.hpp"

#include <Eigen/Core>

#include <cmath>

namespace flotsam {

/// A body in an attitude, at the level where it displaces its own mass. Lengths stand for energies over m g.
struct Attitude {
    Quatd orientation = Quatd::Identity();
    double level = 0.0;                                  ///< of the water above the centre of mass [m]
    double energy = 0.0;                                 ///< z_G - z_B [m]
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();     ///< of the energy by turns about world x and y [m]
    Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero(); ///< its second derivatives: metacentric heights [m]
    Submerged submerged;                                 ///< about the centre of mass
    Waterplane plane;                                    ///< likewise

    /// Up, seen from the body.
    [[nodiscard]] Vec3d up_body() const { return orientation.conjugate() * Vec3d::UnitZ(); }
};

/// Finds attitudes' levels; holds the body's mesh about its centre of mass.
class FlotationSolver {
  public:
    /// Throws std::invalid_argument as flotation says.
    explicit FlotationSolver(const FloatingBody& body);

    [[nodiscard]] bool sinks() const { return displaced_ > whole_ * (1.0 + 1e-12); }
    /// Cube root of the mesh's volume [m]: what lengths are measured by.
    [[nodiscard]] double size() const { return std::cbrt(whole_); }
    /// m g [N].
    [[nodiscard]] double weight() const { return weight_; }
    /// The body must not sink. Throws std::invalid_argument for a quaternion of no direction.
    [[nodiscard]] Attitude at(const Quatd& orientation) const;
    /// The same for a unit quaternion; `level_guess`: of the water above the centre of mass [m].
    [[nodiscard]] Attitude at(const Quatd& orientation, double level_guess) const;
    /// The triangles of hollows in water that is as high as their rims allow, or nearly: 1, others 0.
    [[nodiscard]] std::vector<char> hollows(const Quatd& orientation) const;
    /// With the hollows dry whose rims are above the water, as vessel_flotation says; nothing if she sinks or founders,
    /// or water comes to one of the triangles in `hollows` (those that there are: all, or none).
    [[nodiscard]] std::optional<Attitude> dry_at(const Quatd& orientation, std::span<const char> hollows = {}) const;
    [[nodiscard]] Flotation flotation(const Attitude& attitude) const;

  private:
    /// `wetted`: what of the mesh the water comes to.
    [[nodiscard]] Attitude attitude_in_water(const TriangleMesh& wetted, const Pose& pose, double level) const;

    TriangleMesh mesh_;
    Vec3d center_of_mass_;
    double displaced_;
    double weight_;
    double whole_ = 0.0;
};

/// `upright` turned by a heel [rad] about world x. Throws std::invalid_argument for a quaternion of no direction.
[[nodiscard]] Quatd turned_by_heel(double heel, const Quatd& upright);
[[nodiscard]] RightingArm righting_arm(const FlotationSolver& solver, const Attitude& attitude, double heel);

} // namespace flotsam
