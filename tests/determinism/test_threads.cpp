#include "flotsam/bullet/bullet_coupling.hpp"
#include "support/catch.hpp"

#include <array>
#include <vector>

using namespace flotsam;

namespace {

using Solver = PressureSettings::Solver;

/// What a run leaves behind, bit for bit.
struct Outcome {
    std::uint64_t hash = 0;
    std::size_t particles = 0;
    std::vector<btScalar> bodies; ///< position, rotation and velocities of each
    double water_moved = 0.0;     ///< fastest particle at the end [m/s]
    double bodies_pushed = 0.0;   ///< [N s]
};

void append(std::vector<btScalar>& to, const btRigidBody& body)
{
    const btTransform& t = body.getWorldTransform();
    const btVector3 rows[] = {t.getOrigin(),   t.getBasis()[0],          t.getBasis()[1],
                              t.getBasis()[2], body.getLinearVelocity(), body.getAngularVelocity()};
    for (const btVector3& row : rows) to.insert(to.end(), {row.x(), row.y(), row.z()});
}

btRigidBody make_body(btCollisionShape& shape, double mass, const btVector3& position)
{
    btVector3 inertia;
    shape.calculateLocalInertia(static_cast<btScalar>(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, &shape, inertia);
    info.m_startWorldTransform.setOrigin(position);
    return btRigidBody(info);
}

/// A tank with a box that falls into the water, turning, and a heavier sphere under water.
Outcome run(Solver solver, int threads, FluidWorldSettings::Start start = FluidWorldSettings::Start::as_given)
{
    FluidWorldSettings settings;
    settings.particle_spacing = 0.04;
    settings.pressure.solver = solver;
    settings.threads = threads;
    settings.start = start;
    FluidWorld fluid(settings);
    fluid.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.8, 0.8, 0.8)}, {"+z"});
    fluid.add_block({Vec3d(0, 0, 0), Vec3d(0.8, 0.8, 0.52)});

    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver constraints;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration);
    world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    btBoxShape box_shape(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1)));
    btSphereShape sphere_shape(btScalar(0.1));
    std::array<btRigidBody, 2> bodies = {
        make_body(box_shape, 4.0, btVector3(btScalar(0.25), btScalar(0.4), btScalar(0.56))),
        make_body(sphere_shape, 6.0, btVector3(btScalar(0.6), btScalar(0.4), btScalar(0.3)))};
    bodies[0].setLinearVelocity(btVector3(0, 0, -1));
    bodies[0].setAngularVelocity(btVector3(1, 2, 0));
    BulletCoupling coupling(fluid, world);
    for (btRigidBody& body : bodies) {
        world.addRigidBody(&body);
        coupling.add(body);
    }

    Outcome out;
    for (int k = 0; k < 20; ++k) {
        const StepReport report = coupling.step(0.004);
        out.bodies_pushed += report.body_impulse.norm();
        out.water_moved = report.max_speed;
    }
    out.hash = fluid.state_hash();
    out.particles = fluid.fluid().size();
    for (btRigidBody& body : bodies) {
        append(out.bodies, body);
        world.removeRigidBody(&body);
    }
    return out;
}

void check_equal(const Outcome& a, const Outcome& b)
{
    CHECK(a.hash == b.hash);
    CHECK(a.bodies == b.bodies); // bit for bit: no tolerance
}

} // namespace

TEST_CASE("fluid and bodies end in the same bits for any number of threads", "[determinism]")
{
    const Solver solver = GENERATE(Solver::iisph, Solver::mprgp, Solver::spg);
    const Outcome one = run(solver, 1);
    REQUIRE(one.particles > 4000);
    REQUIRE(one.water_moved > 0.1);
    REQUIRE(one.bodies_pushed > 0.5); // the box lost speed
    check_equal(one, run(solver, 2));
    check_equal(one, run(solver, 3));
    check_equal(one, run(solver, 1)); // and the same run twice
}

TEST_CASE("the solvers differ, so the hash sees what they do", "[determinism]")
{
    CHECK(run(Solver::iisph, 2).hash != run(Solver::mprgp, 2).hash);
    CHECK(run(Solver::spg, 2).hash != run(Solver::mprgp, 2).hash);
}

TEST_CASE("water comes to rest in the same bits for any number of threads", "[determinism]")
{
    constexpr auto kAtRest = FluidWorldSettings::Start::at_rest;
    const Outcome one = run(Solver::spg, 1, kAtRest);
    REQUIRE(one.hash != run(Solver::spg, 1).hash); // it was brought to rest
    REQUIRE(one.bodies_pushed > 0.5);
    check_equal(one, run(Solver::spg, 3, kAtRest));
}
