#pragma once

#include "flotsam/world/fluid_world.hpp"

#include <btBulletDynamicsCommon.h>

#include <memory>

namespace flotsam {

/// Closed mesh of a Bullet shape about the shape's own origin: box, sphere, cylinder, capsule, cone, convex hull,
/// triangle mesh (Bvh, Gimpact), compounds of these (their parts must not cut each other; touching is fine), scaled
/// shapes. Collision margins are not part of it. `max_edge` [m] for round shapes. Throws std::invalid_argument naming a
/// shape without volume.
[[nodiscard]] TriangleMesh mesh_of(const btCollisionShape& shape, double max_edge);

/// Couples bodies of a Bullet world with a FluidWorld, both ways. It holds references only: both worlds and the bodies
/// must outlive it.
class BulletCoupling {
  public:
    BulletCoupling(FluidWorld& fluid, btDynamicsWorld& world);
    ~BulletCoupling();
    BulletCoupling(const BulletCoupling&) = delete;
    BulletCoupling& operator=(const BulletCoupling&) = delete;

    /// Couples a body; its surface is that of its collision shape. Static and kinematic bodies move the water and get
    /// no response. Returns the body's number in the FluidWorld.
    int add(btRigidBody& body);
    /// The same with a surface of its own, closed, in the frame of the body's world transform (whose origin is the
    /// centre of mass).
    int add(btRigidBody& body, const TriangleMesh& surface);

    /// One step of both worlds: at most `dt` seconds, cut to what the fluid allows; returns what was done (report.dt).
    StepReport step(double dt);
    /// Steps until `seconds` have gone by.
    void step_for(double seconds);

    [[nodiscard]] Bodies& bodies(); ///< the port, for FluidWorld::prepare and for reading
    [[nodiscard]] btRigidBody& body(int number) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotsam
