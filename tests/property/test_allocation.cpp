#include "flotsam/bullet/bullet_coupling.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"
#include "support/free_bodies.hpp"

#include <atomic>
#include <cstdlib>

// Sanitizers have an allocator of their own, which must not be replaced.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {
std::atomic<bool> counting = false;
std::atomic<long> allocations = 0;

void count_one()
{
    if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}
} // namespace

// In the place of the C library's, below operator new in all its forms, Eigen's and Bullet's allocators.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size)
{
    count_one();
    return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size)
{
    count_one();
    return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size)
{
    count_one();
    return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size)
{
    count_one();
    return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size)
{
    count_one();
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size)
{
    count_one();
    *out = __libc_memalign(alignment, size);
    return *out == nullptr ? 12 : 0; // ENOMEM
}
}

using namespace flotsam;
using namespace flotsam::test;

namespace {

template <class Action>
long allocations_in(Action&& action)
{
    const long before = allocations;
    counting = true;
    action();
    counting = false;
    return allocations - before;
}

FluidWorldSettings settings_for(int threads, PressureSettings::Solver solver, PressureSettings::Source source)
{
    FluidWorldSettings s;
    s.particle_spacing = 0.04;
    s.threads = threads;
    s.pressure.solver = solver;
    s.pressure.source = source;
    return s;
}

void add_tank_with_wave(FluidWorld& fluid)
{
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.8, 0.6, 0.8)}, {"+z"});
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(0.4, 0.6, 0.36)}, Vec3d(0.5, 0.0, 0.0)); // breaks: neighbours come and go
}

} // namespace

TEST_CASE("the count sees every way to allocate", "[allocation]")
{
    CHECK(allocations_in([] {}) == 0);
    CHECK(allocations_in([] { std::vector<double>().resize(10); }) == 1);
    CHECK(allocations_in([] { Eigen::VectorXd::Zero(10).eval(); }) == 1);
    CHECK(allocations_in([] { btAlignedFree(btAlignedAlloc(64, 16)); }) == 1);
}

TEST_CASE("a step allocates nothing once a run is warm", "[allocation]")
{
    using Solver = PressureSettings::Solver;
    using Source = PressureSettings::Source;
    const Solver solver = GENERATE(Solver::iisph, Solver::mprgp, Solver::spg);
    const Source source = GENERATE(Source::split, Source::published);
    const int threads = GENERATE(1, 2);
    FluidWorld fluid(settings_for(threads, solver, source));
    add_tank_with_wave(fluid);
    const Vec3d edges(0.16, 0.16, 0.16);
    fluid.add_body(tessellate(BoxShape{edges}, 0.04));
    FreeBodies bodies({free_box(edges, 500.0, Vec3d(0.3, 0.3, 0.36))}, Vec3d(0, 0, -9.81));
    // Until the wave has taken it to a wall: a body's faces are cut when it first comes near another solid.
    for (int k = 0; k < 200; ++k) fluid.step(std::min(0.004, fluid.allowed_time_step()), bodies);
    int stopped = 0, worst_step = -1;
    long total = 0;
    for (int k = 0; k < 50; ++k) {
        const double dt = std::min(0.004, fluid.allowed_time_step());
        const long count = allocations_in([&] { stopped += fluid.step(dt, bodies).leaks_stopped; });
        if (count > 0 && worst_step < 0) worst_step = k;
        total += count;
    }
    CAPTURE(threads, stopped, worst_step, static_cast<int>(solver), source == Source::published);
    REQUIRE(fluid.fluid_wrench(0).linear.norm() > 0.0); // the body floats in it
    CHECK(total == 0);
}

TEST_CASE("a step with Bullet allocates nothing once a run is warm", "[allocation]")
{
    FluidWorld fluid(settings_for(1, PressureSettings::Solver::iisph, PressureSettings::Source::split));
    add_tank_with_wave(fluid);
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver constraints;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);
    world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    btBoxShape shape(btVector3(btScalar(0.08), btScalar(0.08), btScalar(0.08)));
    btVector3 inertia;
    shape.calculateLocalInertia(2, inertia);
    btRigidBody body(2, nullptr, &shape, inertia);
    body.setWorldTransform(
        btTransform(btQuaternion::getIdentity(), btVector3(btScalar(0.3), btScalar(0.3), btScalar(0.36))));
    world.addRigidBody(&body);
    BulletCoupling coupling(fluid, world);
    coupling.add(body);
    for (int k = 0; k < 200; ++k) coupling.step(0.004); // until the wave has been to the far wall, and the body at it
    const long count = allocations_in([&] {
        for (int k = 0; k < 50; ++k) coupling.step(0.004);
    });
    CHECK(count == 0);
    world.removeRigidBody(&body);
}

#endif
