#pragma once

#include "flotsam/core/types.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace flotsam {

/// How a kinematic body moves in the coming step. There are two ways to drive one:
/// - the application gives it a pose before the step (by its motion state or setWorldTransform): its twist is what
///   takes it there within the step, and it stands still when no new pose comes;
/// - the application sets its velocity: it goes on with it until another one is set, and move() takes it along.
///
/// Bullet overwrites the velocity of a kinematic body in each step with what it computes from poses, so the velocity
/// that was set is kept here: taken from the body again and again it would drift by rounding.
class KinematicMotion {
  public:
    /// Takes the body's pose now for where it starts from, and its velocity for one that was set.
    void start(btRigidBody& body);
    /// Twist over a step of `dt` seconds from the pose start_pose(); repeated calls give the same.
    Twist plan(const btRigidBody& body, double dt);
    /// After plan(): where a step of `dt` seconds takes the body.
    [[nodiscard]] btTransform end_pose(const btRigidBody& body, double dt) const;
    /// Before Bullet's step: puts a body that has a velocity where that takes it, and wakes one that moves.
    void move(btRigidBody& body, double dt) const;
    /// After Bullet's step: whatever differs from now on was changed by the application.
    void finish(const btRigidBody& body);

    [[nodiscard]] static Pose start_pose(const btRigidBody& body);

    // The same within a tick of the application's own stepSimulation, which has put the body where it is to be after
    // its last sub-step and has set its velocity accordingly. A body put elsewhere without a velocity is there at once.
    Twist plan_in_tick(const btRigidBody& body, double dt);
    [[nodiscard]] const Pose& pose_in_tick() const { return pose_in_tick_; } ///< after plan_in_tick
    void reached(const Pose& pose) { pose_in_tick_ = pose; }

  private:
    [[nodiscard]] bool has_velocity() const { return !set_linear_.isZero() || !set_angular_.isZero(); }

    Pose pose_in_tick_;
    bool rides_ = false; ///< has been planned in a tick
    btTransform seen_pose_ = btTransform::getIdentity();
    btVector3 seen_linear_{0, 0, 0}, seen_angular_{0, 0, 0};
    btVector3 set_linear_{0, 0, 0}, set_angular_{0, 0, 0};
};

} // namespace flotsam
