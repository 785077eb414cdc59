#pragma once

#include "flotsam/scene/scene_file.hpp"
#include "scene/joint_motor.hpp"

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <memory>

namespace flotsam::scene {

/// Where a joint of the scene is now, and what it bears.
struct JointNow {
    double position = 0.0; ///< [rad], whole turns included, or [m]; of a ball in 3-D the angle turned, in [0, pi]
    Wrench wrench;         ///< of `b` or the world on `a` about the joint's point of a, in the last step
};

/// A joint of the scene in its Bullet world: a constraint of Bullet's, and a motor where it has one. Bodies that it
/// joins do not collide with each other.
class BulletJoint {
  public:
    /// The bodies are where the scene starts. For a joint to the world `b` is a body of mass 0.
    BulletJoint(const SceneJoint& joint, btRigidBody& a, btRigidBody& b, btDynamicsWorld& world);
    ~BulletJoint();
    BulletJoint(const BulletJoint&) = delete;
    BulletJoint& operator=(const BulletJoint&) = delete;

    /// After each step of the world.
    void update();
    [[nodiscard]] const JointNow& now() const { return now_; }

  private:
    [[nodiscard]] double measured_position() const;
    [[nodiscard]] Vec3d arm() const; ///< from the joint's point to the centre of mass of a

    SceneJoint::Type type_;
    bool has_axis_;
    btRigidBody &a_, &b_;
    btDynamicsWorld& world_;
    btTransform in_a_, in_b_; ///< the joint's frame in that of each body; its axis is z
    std::unique_ptr<btTypedConstraint> constraint_, motor_;
    btJointFeedback on_a_, motor_on_a_;
    Vec3d arm_; ///< as the last step began
    JointNow now_;
};

} // namespace flotsam::scene
