#pragma once

#include "bullet/constrained_motion.hpp"
#include "bullet/constraint_rows.hpp"
#include "bullet/free_motion.hpp"
#include "bullet/kinematic_motion.hpp"
#include "bullet/mobility.hpp"
#include "bullet/multibody_motion.hpp"
#include "bullet/multibody_rows.hpp"
#include "flotsam/world/bodies.hpp"

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <optional>
#include <utility>
#include <vector>

namespace flotsam {

/// The bodies port over btRigidBodies and links of btMultiBodies of a Bullet world.
///
/// A Bullet step is one or several steps of the fluid. At its start, begin() predicts what Bullet makes of each body
/// that nothing touches, except that locked rotation axes hold (Bullet lets torques and gyroscopic terms turn a body
/// about them) and that a sleeping body stays at rest, and collects the joints and contacts that will hold it; read()
/// and respond() have them inside (ConstrainedMotion). At its end, finish() adds the forces that bring Bullet to that
/// prediction plus what the fluid gave, whatever the body's damping; joints and contacts are then solved by Bullet
/// once more, and disagreement() says how far it came out elsewhere. Between the two, fluid steps shorter than
/// Bullet's move the bodies as they will move: each gets its part of the free motion.
/// Forces, not changes of velocity, which Bullet would damp: a body with much damping would sink. Torques, though, as
/// an angular velocity, with the damping reckoned in: Bullet's friction does not see them (turn).
///
/// A body with an impulse that is not zero is awake: floating at rest needs one in each step, which would lift a
/// sleeping body, to which Bullet applies no gravity. One without is not touched in any way.
class BulletBodies final : public Bodies {
  public:
    explicit BulletBodies(btDynamicsWorld& world) : world_(world) {}

    /// Returns the body's number.
    int add(btRigidBody& body);
    int add(btMultiBodyLinkCollider& link);
    /// Its number stays, without a body.
    void remove(int number);
    [[nodiscard]] int number_of(const btCollisionObject& object) const; ///< -1: not coupled
    [[nodiscard]] btRigidBody& body(int number) const;

    /// When Bullet's next step is `seconds` long. `in_tick`: its stepSimulation has begun, so that gravity is among the
    /// forces and kinematic bodies have been moved.
    void begin(double seconds, bool in_tick);
    void finish();
    void abandon() { seconds_ = 0.0; } ///< the step that begin() began: nothing of it reaches Bullet
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
    [[nodiscard]] std::optional<Vec3d> gravity() const override;

    void before_bullet_step(double dt); ///< moves kinematic bodies
    void after_bullet_step();

  private:
    struct Coupled {
        btRigidBody* body = nullptr;             ///< null: a link, or removed
        btMultiBodyLinkCollider* link = nullptr; ///< null: a rigid body, or removed
        int entity = 0;                          ///< its number in motion_
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
    /// A multibody with coupled links. All of its links are in motion_, base first.
    struct Articulation {
        MultibodyMotion motion;
        int entity = 0; ///< of the base in motion_
        bool is_pushed = false;
        std::vector<Wrench> impulses; ///< per link
    };
    void require_in_world() const;
    void begin_body(Coupled& coupled);
    void begin_dynamic(Coupled& coupled);
    [[nodiscard]] FreeMotion free_motion_of(btRigidBody& body) const;
    [[nodiscard]] bool turn(const Coupled& coupled, const Vec3d& end) const;
    void begin_articulation(Articulation& articulation);
    void begin_link(Coupled& coupled);
    int add_entity(const Twist& start, const Twist& end, const Mat6d& mobility);
    int add_uncoupled(btRigidBody& body);
    void collect_rows();
    void add_multibody_rows();
    [[nodiscard]] int entity_of(const RowEnd& end);
    [[nodiscard]] Articulation* articulation_of(const btMultiBody& body);
    void spread(std::span<const Wrench> impulses) const; ///< to impulses_
    void push_body(Coupled& coupled);
    void push_articulations();
    void guess_impulses(double dt);
    [[nodiscard]] double revision_tolerance() const;
    [[nodiscard]] bool is_open() const { return seconds_ > 0.0; }

    btDynamicsWorld& world_;
    std::vector<Coupled> bodies_;
    std::vector<Articulation> articulations_;
    ConstrainedMotion motion_; ///< coupled bodies, all links of their multibodies, and bodies that hang on them
    MotionNumbers numbers_;
    ConstraintCollector collector_;
    MultibodyRows multibody_rows_;
    std::vector<MultibodyRow> rows_scratch_;
    std::vector<std::pair<btRigidBody*, btTransform>> put_aside_; ///< while rows are collected
    std::vector<Twist> start_, end_;                              ///< of all in motion_, as Coupled has them
    mutable std::vector<Wrench> impulses_;                        ///< of the same
    mutable std::vector<Twist> answers_;                          ///< of the same
    std::vector<Twist> twists_;                                   ///< of the same, at the end of the last fluid step
    double seconds_ = 0.0;                                        ///< of the Bullet step under way; 0: none
    double elapsed_ = 0.0, dt_ = 0.0;
    bool is_in_tick_ = false;
    bool is_single_ = false; ///< the Bullet step is one fluid step, begun by read
};

} // namespace flotsam
