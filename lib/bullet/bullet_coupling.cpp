#include "flotsam/bullet/bullet_coupling.hpp"

#include "bullet/bullet_bodies.hpp"
#include "bullet/step_plan.hpp"
#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {

struct BulletCoupling::Impl {
    FluidWorld& fluid;
    btDynamicsWorld& world;
    BulletBodies bodies;

    /// The longest step now; the first call has the fluid sampled and relaxed, which may change it.
    double allowed_step()
    {
        fluid.prepare(bodies);
        return fluid.allowed_time_step();
    }
};

namespace {

/// Motion in the plane y = 0, beside what is locked already.
void lock_to_plane(btRigidBody& body)
{
    body.setLinearFactor(body.getLinearFactor() * btVector3(1, 0, 1));
    body.setAngularFactor(body.getAngularFactor() * btVector3(0, 1, 0));
}

} // namespace

BulletCoupling::BulletCoupling(FluidWorld& fluid, btDynamicsWorld& world)
    : impl_(new Impl{fluid, world, BulletBodies(world)})
{
}

BulletCoupling::~BulletCoupling() = default;

int BulletCoupling::add(btRigidBody& body)
{
    require(body.getCollisionShape() != nullptr, "a coupled body must have a collision shape");
    return add(body, mesh_of(*body.getCollisionShape(), impl_->fluid.settings().particle_spacing));
}

int BulletCoupling::add(btRigidBody& body, const TriangleMesh& surface)
{
    require(impl_->world.getCollisionObjectArray().findLinearSearch(&body) < impl_->world.getNumCollisionObjects(),
            "a body must be in the Bullet world before it is coupled");
    require(!impl_->bodies.contains(body), "a body must be coupled once only");
    require(impl_->fluid.body_count() == static_cast<int>(impl_->bodies.size()),
            "all bodies of a coupled FluidWorld must be added through its BulletCoupling");
    const int number = impl_->fluid.add_body(surface);
    if (impl_->fluid.settings().dimensions == 2) lock_to_plane(body);
    impl_->bodies.add(body);
    return number;
}

StepReport BulletCoupling::step(double dt)
{
    require(dt > 0.0 && std::isfinite(dt), "a step must be > 0 s and finite", dt);
    const double allowed = impl_->allowed_step();
    StepReport report = impl_->fluid.step(std::min(dt, allowed), impl_->bodies);
    impl_->bodies.before_bullet_step(report.dt);
    impl_->world.stepSimulation(static_cast<btScalar>(report.dt), 0); // 0: one step of exactly this length
    impl_->bodies.after_bullet_step();
    return report;
}

void BulletCoupling::step_for(double seconds)
{
    require(seconds >= 0.0 && std::isfinite(seconds), "a time to step for must be >= 0 s and finite", seconds);
    double left = seconds;
    while (left > 0.0) left -= step(next_step(left, impl_->allowed_step())).dt;
}

Bodies& BulletCoupling::bodies()
{
    return impl_->bodies;
}

btRigidBody& BulletCoupling::body(int number) const
{
    return impl_->bodies.body(number);
}

} // namespace flotsam
