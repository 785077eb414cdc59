#pragma once

#include "bullet/multibody_kinematics.hpp"
#include "bullet/multibody_mobility.hpp"

#include <LinearMath/btAlignedObjectArray.h>

#include <span>
#include <vector>

namespace flotsam {

/// A btMultiBody as the bodies port needs it: what Bullet's next step makes of it, how its links answer impulses, and
/// how impulses get to Bullet. Links are counted with the base: 0 is the base, k + 1 is Bullet's link k.
///
/// **Differs** from Bullet where the multibody integrates by Runge and Kutta: the prediction is that of an Euler step.
/// No allocation after the first read; one thread.
class MultibodyMotion {
  public:
    explicit MultibodyMotion(btMultiBody& body) : body_(&body) {}

    [[nodiscard]] btMultiBody& body() const { return *body_; }
    [[nodiscard]] int size() const { return body_->getNumLinks() + 1; }

    /// Prepares a step of `dt` seconds, > 0. Gravity is the world's [m/s^2]; `is_gravity_in_forces` inside of
    /// stepSimulation (in its tick callbacks), where Bullet has added it to the forces on the links.
    ///
    /// Nothing of the multibody changes but what Bullet caches of its pose: the links' m_cachedWorldTransform, which is
    /// of the start of Bullet's last step, is brought up to date, and calcAccelerationDeltasMultiDof can be called.
    void read(double dt, const Vec3d& gravity, bool is_gravity_in_forces);

    // As of the last read:
    [[nodiscard]] const Pose& pose(int link) const { return kinematics_.pose(link); } ///< of the centre of mass
    [[nodiscard]] Twist twist(int link) const { return kinematics_.twist(link, now_); }
    /// At the end of the step with gravity, applied forces and torques, Bullet's damping, gyroscopic and other velocity
    /// terms, but without constraints, contacts and water; at rest if it is asleep. The velocity of the joints is that
    /// of the end, their place that of the start.
    [[nodiscard]] Twist predicted(int link) const { return kinematics_.twist(link, predicted_); }
    /// The same in joint space, in Bullet's order: angular and linear velocity of the base, then the joints.
    [[nodiscard]] const Eigen::VectorXd& predicted_joint_velocity() const { return predicted_; }
    [[nodiscard]] bool is_asleep() const { return is_asleep_; }
    [[nodiscard]] const MultibodyKinematics& kinematics() const { return kinematics_; }
    [[nodiscard]] const MultibodyMobility& mobility() const { return mobility_; }

    /// Adds the forces that bring Bullet's step to predicted + mobility * impulses. `impulses`: one per link [N s].
    ///
    /// Bullet damps by the velocity at the start of the step, so that nothing of these forces is damped. An impulse
    /// wakes a multibody that sleeps and clears the other forces on it: Bullet does not clear those of a sleeping one,
    /// so that the gravity of its last step, and all that an application adds, pile up.
    void apply(std::span<const Wrench> impulses);
    /// Takes the forces of apply back, for the next of several steps within one stepSimulation, whose end clears them.
    void withdraw();
    /// After the end of stepSimulation: there is nothing to take back.
    void forget();

  private:
    void accelerate();                      ///< unaided_: the accelerations of Bullet's articulated-body pass
    void add_gravity(const Vec3d& gravity); ///< to unaided_
    void predict();
    void wake();
    void add_force(int link, const Wrench& force);

    btMultiBody* body_;
    double dt_ = 0.0;
    bool is_asleep_ = false;
    Vec3d left_out_ = Vec3d::Zero(); ///< gravity that Bullet has not added because the multibody slept
    MultibodyKinematics kinematics_;
    MultibodyMobility mobility_;
    Eigen::VectorXd now_, unaided_, predicted_; ///< in joint space
    std::vector<Wrench> applied_;               ///< forces, per link

    /// What Bullet's articulated-body pass writes beside its caches.
    struct PutAside {
        btMultiBodyJointFeedback* feedback;
        btSpatialMotionVector total_velocity, joint_velocity;
    };
    std::vector<PutAside> put_aside_;
    btAlignedObjectArray<btScalar> numbers_;
    btAlignedObjectArray<btVector3> vectors_;
    btAlignedObjectArray<btMatrix3x3> matrices_;
    btAlignedObjectArray<btQuaternion> rotations_;
};

/// Whether Bullet leaves the multibody out of its steps: one of its colliders is in an island that sleeps.
[[nodiscard]] bool is_asleep(const btMultiBody& body);

} // namespace flotsam
