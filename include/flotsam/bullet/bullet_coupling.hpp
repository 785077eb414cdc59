#pragma once

#include "flotsam/world/fluid_world.hpp"

#include <btBulletDynamicsCommon.h>

#include <memory>

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
/// Contacts and constraints stay with Bullet's solver. The water answers a body as if it were free of them and finds
/// out with the next step what they made of it.
class BulletCoupling {
  public:
    BulletCoupling(FluidWorld& fluid, btDynamicsWorld& world);
    ~BulletCoupling();
    BulletCoupling(const BulletCoupling&) = delete;
    BulletCoupling& operator=(const BulletCoupling&) = delete;

    /// Couples a body, which must be in the Bullet world; its surface is that of its collision shape. Returns the
    /// body's number in the FluidWorld.
    ///
    /// Static and kinematic bodies move the water and get no response. A kinematic body goes on with the velocity that
    /// is set on it (setLinearVelocity, setAngularVelocity); or it goes within the next step to the pose that the
    /// application gives it (setWorldTransform or its motion state) and then stands still.
    int add(btRigidBody& body);
    /// The same with a surface of its own, closed, in the frame of the body's world transform (whose origin is the
    /// centre of mass).
    int add(btRigidBody& body, const TriangleMesh& surface);

    /// One step of both worlds: at most `dt` seconds, > 0, cut to what the fluid allows; returns what was done
    /// (report.dt). The Bullet world makes one step of the same length, stepSimulation(report.dt, 0).
    StepReport step(double dt);
    /// Steps until `seconds`, >= 0, have gone by; the last step ends exactly there.
    void step_for(double seconds);

    /// The port, for FluidWorld::prepare and for reading. Its apply adds forces for a Bullet step of the `dt` of its
    /// last read.
    [[nodiscard]] Bodies& bodies();
    [[nodiscard]] btRigidBody& body(int number) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // inline namespace
} // namespace flotsam
