#pragma once

#include "bullet/kinematic_motion.hpp"
#include "bullet/mobility.hpp"
#include "flotsam/world/bodies.hpp"

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <vector>

namespace flotsam {

/// The bodies port over btRigidBodies of a Bullet world.
///
/// read() predicts what stepSimulation(dt, 0) makes of a body that nothing touches, except that locked rotation axes
/// hold (Bullet lets torques and gyroscopic terms turn a body about them) and that a sleeping body stays at rest.
/// apply() adds the force that brings Bullet to predicted + respond(impulses) at the end of the step, whatever the
/// body's damping. **Rejected:** changing velocities instead; Bullet would damp the fluid's part of them, but not
/// gravity's, and a body with much damping would sink.
///
/// A body with an impulse that is not zero is awake: floating at rest needs one in each step, which would lift a
/// sleeping body, to which Bullet applies no gravity.
class BulletBodies final : public Bodies {
  public:
    explicit BulletBodies(btDynamicsWorld& world) : world_(world) {}

    /// Returns the body's number.
    int add(btRigidBody& body);
    [[nodiscard]] bool contains(const btRigidBody& body) const;
    [[nodiscard]] btRigidBody& body(int number) const;

    [[nodiscard]] std::size_t size() const override { return bodies_.size(); }
    void read(double dt, std::span<BodyState> states) override;
    /// As of the last read.
    void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const override;
    /// Bullet's next step must be one of the `dt` of the last read.
    void apply(std::span<const Wrench> impulses) override;

    void before_bullet_step(double dt); ///< moves kinematic bodies
    void after_bullet_step();

  private:
    struct Coupled {
        btRigidBody* body = nullptr;
        KinematicMotion kinematic;
        bool was_kinematic = false;
        bool is_asleep = false;
        Mobility mobility; ///< zero for what does not respond
        Twist predicted;   ///< as promised to the fluid
        Twist unaided;     ///< where Bullet's step takes the body if it is awake and no force is added
    };
    BodyState read_static(Coupled& coupled) const;
    BodyState read_kinematic(Coupled& coupled, double dt) const;
    BodyState read_dynamic(Coupled& coupled, double dt) const;

    btDynamicsWorld& world_;
    std::vector<Coupled> bodies_;
    double dt_ = 0.0;
};

} // namespace flotsam
