#pragma once

#include "flotsam/world/fluid_world.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>

#include <functional>
#include <memory>
#include <vector>

namespace flotsam {

// Bullet's classes have the same names with float and with double numbers, but not the same size. Ours have different
// ones, so that an application compiled for the other kind than flotsam::bullet fails to link instead of corrupting.
#if defined(BT_USE_DOUBLE_PRECISION)
inline namespace bullet_double {
#else
inline namespace bullet_single {
#endif

/// Closed mesh of a Bullet shape about the shape's own origin: box, sphere, cylinder, capsule, cone, convex hull,
/// triangle mesh (Bvh, Gimpact), compounds of these (their parts must not cut each other; touching is fine), scaled
/// shapes. Collision margins are not part of it. `max_edge` [m] for round shapes, which have exactly the shape's
/// volume. Throws std::invalid_argument naming a shape without volume; InputError as check_mesh does for a triangle
/// mesh that is no closed surface.
[[nodiscard]] TriangleMesh mesh_of(const btCollisionShape& shape, double max_edge);

/// Couples bodies of a Bullet world with a FluidWorld, both ways. It holds references only: both worlds and the bodies
/// must outlive it.
///
/// Locked axes (linear and angular factors of 0) hold exactly. A body that the water touches stays awake; one that
/// sleeps elsewhere is woken by the first impulse. In a FluidWorld of two dimensions bodies are locked to the plane.
///
/// Joints (btTypedConstraint, limits and motors included) and contacts stand inside the pressure solve, those with
/// bodies that the fluid does not know too: the water feels how bodies that hold on to each other answer together.
/// Bullet's own solver then has the last word; StepReport::disagreement says how far it came out elsewhere. Bodies that
/// the water does not touch move as Bullet alone moves them, bit for bit.
///
/// There are two ways to step:
/// - step and step_for step both worlds;
/// - attach lets the fluid ride on the application's own stepSimulation, whatever its sub-steps.
class BulletCoupling {
  public:
    BulletCoupling(FluidWorld& fluid, btDynamicsWorld& world);
    ~BulletCoupling();
    BulletCoupling(const BulletCoupling&) = delete;
    BulletCoupling& operator=(const BulletCoupling&) = delete;

    /// Couples a body, which must be in the Bullet world; its surface is that of its collision shape. Returns the
    /// body's number in the FluidWorld. Between steps bodies may be added (water in their place is removed), removed,
    /// put elsewhere (water in the new place goes to the old one) and reshaped; throws std::logic_error while a step
    /// runs.
    ///
    /// Static and kinematic bodies move the water and get no response. A kinematic body goes on with the velocity that
    /// is set on it (setLinearVelocity, setAngularVelocity); or it goes within the next step to the pose that the
    /// application gives it (setWorldTransform or its motion state) and then stands still. With attach only the second
    /// holds, as Bullet has it.
    int add(btRigidBody& body);
    /// The same with a surface of its own, closed, in the frame of the body's world transform (whose origin is the
    /// centre of mass).
    int add(btRigidBody& body, const TriangleMesh& surface);
    /// Couples a link (or the base) of a multibody of the world, which must be a btMultiBodyDynamicsWorld. A push on
    /// one link moves the others inside the pressure solve; motors and limits (btMultiBodyConstraint) stand inside it
    /// too.
    int add(btMultiBodyLinkCollider& link);
    int add(btMultiBodyLinkCollider& link, const TriangleMesh& surface);
    /// All links that have a collider, base first; returns their numbers.
    std::vector<int> add(btMultiBody& body);
    /// To be called before the body is removed from the Bullet world: a step without it there throws
    /// std::invalid_argument with its number. That is not used again.
    void remove(btCollisionObject& body);
    /// Gives a coupled body another surface; its collision shape's, or its own.
    void reshape(btCollisionObject& body);
    void reshape(btCollisionObject& body, const TriangleMesh& surface);

    /// One step of both worlds: at most `dt` seconds, > 0, cut to what the fluid allows; returns what was done
    /// (report.dt). The Bullet world makes one step of the same length, stepSimulation(report.dt, 0).
    StepReport step(double dt);
    /// Steps until `seconds`, >= 0, have gone by; the last step ends exactly there.
    void step_for(double seconds);

    /// From now on the fluid steps inside each internal step ("tick") of the world's stepSimulation, in as many steps
    /// of its own as it needs. Takes the world's pre-tick callback and user info, and adds an action; an application
    /// that has a pre-tick callback itself calls before_tick from it and after_tick from its tick callback instead.
    /// `on_step` is told of each step of the fluid; what it throws comes out of stepSimulation, whose forces are then
    /// cleared as at its end: the tick is left out by Bullet, while steps that the fluid has made in it stay. Throws
    /// std::logic_error where another coupling is attached to the world: of two, the first would no longer be called.
    void attach(std::function<void(const StepReport&)> on_step = {});
    void detach(); ///< done by the destructor too
    void before_tick(double dt);
    void after_tick();

    /// The port, for FluidWorld::prepare and for reading. Its apply adds forces for a Bullet step of the `dt` of its
    /// last read.
    [[nodiscard]] Bodies& bodies();
    [[nodiscard]] btRigidBody& body(int number) const;
    /// Number of a body, -1 for one that is not coupled.
    [[nodiscard]] int number_of(const btCollisionObject& body) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // inline namespace
} // namespace flotsam
