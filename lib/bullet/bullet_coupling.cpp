#include "flotsam/bullet/bullet_coupling.hpp"

#include "bullet/bullet_bodies.hpp"
#include "bullet/step_plan.hpp"
#include "flotsam/core/contracts.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace flotsam {
namespace {

/// Motion in the plane y = 0, beside what is locked already.
void lock_to_plane(btRigidBody& body)
{
    body.setLinearFactor(body.getLinearFactor() * btVector3(1, 0, 1));
    body.setAngularFactor(body.getAngularFactor() * btVector3(0, 1, 0));
}

/// Runs as the last thing of each tick.
class AfterTick final : public btActionInterface {
  public:
    explicit AfterTick(BulletCoupling& coupling) : coupling_(coupling) {}
    void updateAction(btCollisionWorld*, btScalar) override { coupling_.after_tick(); }
    void debugDraw(btIDebugDraw*) override {}

  private:
    BulletCoupling& coupling_;
};

void before_tick_callback(btDynamicsWorld* world, btScalar dt)
{
    static_cast<BulletCoupling*>(world->getWorldUserInfo())->before_tick(static_cast<double>(dt));
}

/// Bullet keeps it to derived classes.
struct PreTick : btDynamicsWorld {
    static btInternalTickCallback of(const btDynamicsWorld& world)
    {
        return world.*(&PreTick::m_internalPreTickCallback);
    }
};

} // namespace

struct BulletCoupling::Impl {
    FluidWorld& fluid;
    btDynamicsWorld& world;
    BulletBodies bodies;
    std::unique_ptr<AfterTick> after_tick; ///< while attached
    void* user_info_before = nullptr;      ///< of the world
    std::function<void(const StepReport&)> on_step;
    double disagreement = 0.0; ///< of the last Bullet step
    bool is_stepping = false;

    /// The longest step now; the first call has the fluid sampled and relaxed, which may change it.
    double allowed_step()
    {
        fluid.prepare(bodies);
        return fluid.allowed_time_step();
    }
    /// The fluid's part of a tick of `dt` seconds.
    void step_fluid(double dt)
    {
        bodies.begin(dt, true);
        allowed_step();
        for (double left = dt; left > 0.0;) {
            StepReport report = fluid.step(next_step(left, fluid.allowed_time_step()), bodies);
            report.disagreement = std::exchange(disagreement, 0.0);
            left -= report.dt;
            if (on_step) on_step(report);
        }
        bodies.finish();
    }
    void require_all_ours() const
    {
        require(fluid.body_count() == static_cast<int>(bodies.size()),
                "all bodies of a coupled FluidWorld must be added through its BulletCoupling");
    }
    void require_no_step() const
    {
        if (is_stepping) throw std::logic_error("bodies must not be added, removed or reshaped while a step runs");
    }
};

namespace {

/// Sets a flag for as long as it lives.
class Flag {
  public:
    explicit Flag(bool& flag) : flag_(flag) { flag_ = true; }
    ~Flag() { flag_ = false; }
    Flag(const Flag&) = delete;
    Flag& operator=(const Flag&) = delete;

  private:
    bool& flag_;
};

} // namespace

BulletCoupling::BulletCoupling(FluidWorld& fluid, btDynamicsWorld& world)
    : impl_(new Impl{fluid, world, BulletBodies(world), nullptr, nullptr, {}})
{
}

BulletCoupling::~BulletCoupling()
{
    detach();
}

int BulletCoupling::add(btRigidBody& body)
{
    require(body.getCollisionShape() != nullptr, "a coupled body must have a collision shape");
    return add(body, mesh_of(*body.getCollisionShape(), impl_->fluid.settings().particle_spacing));
}

int BulletCoupling::add(btRigidBody& body, const TriangleMesh& surface)
{
    impl_->require_no_step();
    require(impl_->world.getCollisionObjectArray().findLinearSearch(&body) < impl_->world.getNumCollisionObjects(),
            "a body must be in the Bullet world before it is coupled");
    require(number_of(body) < 0, "a body must be coupled once only");
    impl_->require_all_ours();
    const int number = impl_->fluid.add_body(surface);
    if (impl_->fluid.settings().dimensions == 2) lock_to_plane(body);
    impl_->bodies.add(body);
    return number;
}

int BulletCoupling::add(btMultiBodyLinkCollider& link)
{
    require(link.getCollisionShape() != nullptr, "a coupled link must have a collision shape");
    return add(link, mesh_of(*link.getCollisionShape(), impl_->fluid.settings().particle_spacing));
}

int BulletCoupling::add(btMultiBodyLinkCollider& link, const TriangleMesh& surface)
{
    impl_->require_no_step();
    require(dynamic_cast<btMultiBodyDynamicsWorld*>(&impl_->world) != nullptr,
            "links of multibodies need a btMultiBodyDynamicsWorld");
    require(link.m_multiBody != nullptr &&
                impl_->world.getCollisionObjectArray().findLinearSearch(&link) < impl_->world.getNumCollisionObjects(),
            "a link's collider must be in the Bullet world before it is coupled");
    require(number_of(link) < 0, "a link must be coupled once only");
    impl_->require_all_ours();
    const int number = impl_->fluid.add_body(surface);
    impl_->bodies.add(link);
    return number;
}

std::vector<int> BulletCoupling::add(btMultiBody& body)
{
    std::vector<int> numbers;
    for (int link = -1; link < body.getNumLinks(); ++link) {
        btMultiBodyLinkCollider* collider = link < 0 ? body.getBaseCollider() : body.getLink(link).m_collider;
        if (collider != nullptr) numbers.push_back(add(*collider));
    }
    return numbers;
}

void BulletCoupling::remove(btCollisionObject& body)
{
    impl_->require_no_step();
    const int number = number_of(body);
    require(number >= 0, "a body must be coupled to be removed");
    impl_->fluid.remove_body(number);
    impl_->bodies.remove(number);
}

void BulletCoupling::reshape(btCollisionObject& body)
{
    require(body.getCollisionShape() != nullptr, "a coupled body must have a collision shape");
    reshape(body, mesh_of(*body.getCollisionShape(), impl_->fluid.settings().particle_spacing));
}

void BulletCoupling::reshape(btCollisionObject& body, const TriangleMesh& surface)
{
    impl_->require_no_step();
    const int number = number_of(body);
    require(number >= 0, "a body must be coupled to be reshaped");
    impl_->fluid.reshape_body(number, surface);
}

StepReport BulletCoupling::step(double dt)
{
    require(dt > 0.0 && std::isfinite(dt), "a step must be > 0 s and finite", dt);
    require(impl_->after_tick == nullptr, "an attached coupling must be stepped by its world's stepSimulation");
    impl_->require_no_step();
    const double allowed = impl_->allowed_step();
    const Flag flag(impl_->is_stepping);
    StepReport report = impl_->fluid.step(std::min(dt, allowed), impl_->bodies);
    impl_->bodies.before_bullet_step(report.dt);
    impl_->world.stepSimulation(static_cast<btScalar>(report.dt), 0); // 0: one step of exactly this length
    report.disagreement = impl_->bodies.disagreement();
    impl_->bodies.after_bullet_step();
    return report;
}

void BulletCoupling::step_for(double seconds)
{
    require(seconds >= 0.0 && std::isfinite(seconds), "a time to step for must be >= 0 s and finite", seconds);
    double left = seconds;
    while (left > 0.0) left -= step(next_step(left, impl_->allowed_step())).dt;
}

void BulletCoupling::attach(std::function<void(const StepReport&)> on_step)
{
    require(impl_->after_tick == nullptr, "a coupling must be attached once only");
    if (PreTick::of(impl_->world) == before_tick_callback)
        throw std::logic_error("another coupling is attached to this Bullet world, and one only can be; to ride along "
                               "with both, call before_tick and after_tick of each from callbacks of your own");
    impl_->on_step = std::move(on_step);
    impl_->user_info_before = impl_->world.getWorldUserInfo();
    impl_->world.setInternalTickCallback(before_tick_callback, this, true);
    impl_->after_tick = std::make_unique<AfterTick>(*this);
    impl_->world.addAction(impl_->after_tick.get());
}

void BulletCoupling::detach()
{
    if (impl_->after_tick == nullptr) return;
    impl_->world.setInternalTickCallback(nullptr, impl_->user_info_before, true);
    impl_->world.removeAction(impl_->after_tick.get());
    impl_->after_tick.reset();
}

void BulletCoupling::before_tick(double dt)
{
    require(dt > 0.0 && std::isfinite(dt), "a tick must be > 0 s and finite", dt);
    impl_->is_stepping = true; // until the tick is over, which it is too when something throws
    try {
        impl_->step_fluid(dt);
    } catch (...) {
        impl_->bodies.abandon();
        impl_->world.clearForces(); // as stepSimulation would at its end; else the next would add gravity to gravity
        impl_->is_stepping = false;
        throw;
    }
}

void BulletCoupling::after_tick()
{
    impl_->bodies.take_back_forces();
    impl_->disagreement = impl_->bodies.disagreement();
    impl_->is_stepping = false;
}

Bodies& BulletCoupling::bodies()
{
    return impl_->bodies;
}

btRigidBody& BulletCoupling::body(int number) const
{
    return impl_->bodies.body(number);
}

int BulletCoupling::number_of(const btCollisionObject& body) const
{
    return impl_->bodies.number_of(body);
}

} // namespace flotsam
