#pragma once

#include "flotsam/core/types.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <vector>

namespace flotsam {

/// Where the base and the links of a btMultiBody are, and how they move with its joints.
///
/// Links are counted with the base: 0 is the base, k + 1 is Bullet's link k. Velocities in joint space are in Bullet's
/// order: angular and linear velocity of the base (world frame), then the joints. Everything is computed in double from
/// the joints' own frames, because what Bullet caches of the links in the world is of the start of its last step.
class MultibodyKinematics {
  public:
    /// No allocation after the first call for the same multibody.
    void update(const btMultiBody& body);

    [[nodiscard]] int size() const { return static_cast<int>(poses_.size()); } ///< base and links
    [[nodiscard]] int dofs() const { return static_cast<int>(jacobian_transposed_.rows()); }
    [[nodiscard]] const Pose& pose(int link) const { return poses_[static_cast<std::size_t>(link)]; }
    /// Twist of a link (linear, angular; world frame, about its centre of mass) per velocity in joint space,
    /// transposed: dofs() x 6.
    [[nodiscard]] auto jacobian_transposed(int link) const { return jacobian_transposed_.middleCols<6>(6 * link); }

    [[nodiscard]] Twist twist(int link, const Eigen::VectorXd& joint_velocity) const;
    /// Adds what a wrench on a link is in joint space.
    void gather(int link, const Wrench& wrench, Eigen::VectorXd& joint_force) const;

  private:
    std::vector<Pose> poses_;
    Eigen::MatrixXd jacobian_transposed_; ///< dofs() x 6 size()
};

/// Mass and inertia tensor (world frame) of the base or a link.
struct LinkInertia {
    double mass = 0.0;
    Mat3d tensor = Mat3d::Zero();

    [[nodiscard]] Wrench operator*(const Twist& twist) const { return {mass * twist.linear, tensor * twist.angular}; }
};

[[nodiscard]] LinkInertia inertia_of(const btMultiBody& body, int link, const Pose& pose);

} // namespace flotsam
