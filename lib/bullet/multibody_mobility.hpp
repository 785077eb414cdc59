#pragma once

#include "bullet/multibody_kinematics.hpp"

#include <span>

namespace flotsam {

/// How the links of a btMultiBody answer impulses on them: Y = J H^-1 J^T with the mass matrix H of its joint space.
///
/// With H = L^T L and W = L^-T J^T it is Y = W^T W, symmetric and positive semi-definite whatever the rounding.
/// **Source:** Featherstone, Rigid Body Dynamics Algorithms (2008), 6.2 and 8.3: eliminating from the leaves to the
/// base has the joint inertias of the articulated-body algorithm for pivots. **Differs** from asking Bullet for the
/// columns of H^-1 (calcAccelerationDeltasMultiDof), which gives the same up to Bullet's rounding, but in single
/// precision neither symmetric nor semi-definite. What Bullet holds still is held still here: a base that is fixed,
/// static or kinematic, kinematic links, and a joint whose inertia is below Bullet's SIMD_EPSILON.
class MultibodyMobility {
  public:
    /// No allocation after the first call for the same multibody.
    void update(const btMultiBody& body, const MultibodyKinematics& kinematics);

    [[nodiscard]] bool is_held(int dof) const { return !(inv_root_[dof] > 0.0); }
    [[nodiscard]] bool responds(int link) const; ///< whether any impulse moves it
    /// H^-1 times a force in joint space, in place; 0 for what is held.
    void accelerate(Eigen::VectorXd& joint_force) const;
    /// Twists of links per impulses on links, 6 x 6: linear, angular.
    [[nodiscard]] Eigen::Matrix<double, 6, 6> block(int to, int from) const;
    /// `impulses` and `twists`: one per link, base first.
    void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const;

  private:
    void factor(const btMultiBody& body);
    void half_solve(Eigen::Ref<Eigen::VectorXd> x) const; ///< L^-T x

    Eigen::MatrixXd upper_;    ///< H, then L^T above its diagonal
    Eigen::VectorXd inv_root_; ///< 1 / diagonal of L, 0 where held
    Eigen::VectorXd smallest_; ///< pivots up to these are held
    Eigen::MatrixXd half_;     ///< W, dofs x 6 links
    mutable Eigen::VectorXd joint_;
};

} // namespace flotsam
