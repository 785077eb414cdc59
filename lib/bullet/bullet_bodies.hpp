#pragma once

#include "bullet/constrained_motion.hpp"
#include "bullet/constraint_rows.hpp"
#include "bullet/kinematic_motion.hpp"
#include "bullet/mobility.hpp"
#include "flotsam/world/bodies.hpp"

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

namespace flotsam {

/// The bodies port over btRigidBodies of a Bullet world.
///
/// A Bullet step is one or several steps of the fluid. At its start, begin() predicts what Bullet makes of each body
/// that nothing touches, except that locked rotation axes hold (Bullet lets torques and gyroscopic terms turn a body
/// about them) and that a sleeping body stays at rest, and collects the joints and contacts that will hold it; read()
/// and respond() have them inside (ConstrainedMotion). At its end, finish() adds the forces that bring Bullet to that
/// prediction plus what the fluid gave, whatever the body's damping; joints and contacts are then solved by Bullet
/// once more, and disagreement() says how far it came out elsewhere. Between the two, fluid steps shorter than
/// Bullet's move the bodies as they will move: each gets its part of the free motion.
/// **Rejected:** changing velocities instead of adding forces; Bullet would damp the fluid's part of them, but not
/// gravity's, and a body with much damping would sink.
///
/// A body with an impulse that is not zero is awake: floating at rest needs one in each step, which would lift a
/// sleeping body, to which Bullet applies no gravity. One without is not touched in any way.
class BulletBodies final : public Bodies {
  public:
    explicit BulletBodies(btDynamicsWorld& world) : world_(world) {}

    /// Returns the body's number.
    int add(btRigidBody& body);
    /// Its number stays, without a body.
    void remove(int number);
    [[nodiscard]] int number_of(const btRigidBody& body) const; ///< -1: not coupled
    [[nodiscard]] btRigidBody& body(int number) const;

    /// When Bullet's next step is `seconds` long. `in_tick`: its stepSimulation has begun, so that gravity is among the
    /// forces and kinematic bodies have been moved.
    void begin(double seconds, bool in_tick);
    void finish();
    /// Takes back the forces of finish(), in the same stepSimulation.
    void take_back_forces();
    /// After Bullet's step: largest difference of a coupled body's velocity from what the fluid believed in [m/s].
    [[nodiscard]] double disagreement() const;

    [[nodiscard]] std::size_t size() const override { return bodies_.size(); }
    /// Between begin() and finish() the next part of that step; else it is a Bullet step by itself.
    void read(double dt, std::span<BodyState> states) override;
    void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const override;
    bool own_mobility(std::span<Mat6d> blocks) const override;
    bool revise(std::span<const Wrench> impulses, std::span<BodyState> states) override;
    void apply(std::span<const Wrench> impulses) override;

    void before_bullet_step(double dt); ///< moves kinematic bodies
    void after_bullet_step();

  private:
    struct Coupled {
        btRigidBody* body = nullptr; ///< null: removed
        KinematicMotion kinematic;
        bool was_kinematic = false;
        bool is_dynamic = false, is_asleep = false;
        Mobility mobility; ///< its own, zero for what does not respond
        Twist start;       ///< as the Bullet step begins
        Twist end;         ///< where its free motion ends, as promised to the fluid
        Twist unaided;     ///< where Bullet's step takes the body if it is awake and no force is added
        Wrench given;      ///< by the fluid in this Bullet step [N s]
        Wrench last_given; ///< in the one before, per second of it [N]
        Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero(); ///< that finish() added
        Pose pose;                                           ///< now, as the fluid has it
        Twist twist;
    };
    void begin_body(Coupled& coupled, double seconds, bool in_tick);
    void begin_dynamic(Coupled& coupled, double seconds, bool in_tick);
    [[nodiscard]] bool turn(const Coupled& coupled, const Vec3d& end) const;
    void collect_rows(bool in_tick);
    int add_uncoupled(btRigidBody& body, bool in_tick);
    void guess_impulses(double dt);
    [[nodiscard]] double revision_tolerance() const;
    [[nodiscard]] bool is_open() const { return seconds_ > 0.0; }

    btDynamicsWorld& world_;
    std::vector<Coupled> bodies_;
    ConstrainedMotion motion_; ///< coupled bodies by their numbers, then others that hang on them
    MotionNumbers numbers_;
    ConstraintCollector collector_;
    std::vector<Twist> uncoupled_start_, uncoupled_end_; ///< as Coupled has them
    mutable std::vector<Wrench> impulses_;               ///< of all bodies in motion_
    mutable std::vector<Twist> answers_;                 ///< of the same
    std::vector<Twist> twists_;                          ///< of the same, at the end of the last fluid step
    double seconds_ = 0.0;                               ///< of the Bullet step under way; 0: none
    double elapsed_ = 0.0, dt_ = 0.0;
    bool is_in_tick_ = false;
    bool is_single_ = false; ///< the Bullet step is one fluid step, begun by read
};

} // namespace flotsam
