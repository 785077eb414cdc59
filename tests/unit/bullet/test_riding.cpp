#include "bullet_scene.hpp"
#include "flotsam/bullet/bullet_coupling.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"

#include <cmath>
#include <stdexcept>

using namespace flotsam;
using namespace flotsam::test;

namespace {

FluidWorldSettings coarse()
{
    FluidWorldSettings settings;
    settings.particle_spacing = 0.05;
    settings.threads = 1;
    return settings;
}

void add_tank(FluidWorld& water)
{
    water.add_box_wall({Vec3d(0, 0, 0), Vec3d(0.8, 0.8, 0.8)}, {"+z"});
    water.add_block({Vec3d(0, 0, 0), Vec3d(0.8, 0.8, 0.4)});
}

/// A cube of 0.3 m, as heavy as half of its volume of water.
btRigidBody& add_cube(BulletScene& scene, const Vec3d& position, double mass = 13.5)
{
    auto& box = scene.shape<btBoxShape>(btVector3(btScalar(0.15), btScalar(0.15), btScalar(0.15)));
    btVector3 inertia(0, 0, 0);
    box.calculateLocalInertia(static_cast<btScalar>(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, &box, inertia);
    info.m_startWorldTransform.setOrigin(to_bullet(position));
    return scene.add(info);
}

/// Water and Bullet in a tank, coupled.
struct CoupledTank {
    BulletScene scene;
    FluidWorld water{coarse()};
    BulletCoupling coupling{water, scene.world};

    CoupledTank() { add_tank(water); }
    btRigidBody& add(const Vec3d& position)
    {
        btRigidBody& cube = add_cube(scene, position);
        coupling.add(cube);
        return cube;
    }
};

double height(const btRigidBody& body)
{
    return static_cast<double>(body.getWorldTransform().getOrigin().z());
}

bool same_bits(const btRigidBody& a, const btRigidBody& b)
{
    return a.getWorldTransform() == b.getWorldTransform() && a.getLinearVelocity() == b.getLinearVelocity() &&
           a.getAngularVelocity() == b.getAngularVelocity();
}

} // namespace

TEST_CASE("the fluid rides on the application's steps, whatever their kind", "[bullet][riding]")
{
    struct Stepping {
        double frame;
        int sub_steps;
        double tick;
    };
    const auto stepping =
        GENERATE(Stepping{0.004, 0, 0.004}, Stepping{1.0 / 60, 10, 1.0 / 240}, Stepping{1.0 / 60, 1, 1.0 / 60});
    BulletScene scene;
    btRigidBody& cube = add_cube(scene, Vec3d(0.4, 0.4, 0.4));
    cube.setDamping(btScalar(0.3), btScalar(0.3)); // to rest sooner
    FluidWorld water(coarse());
    add_tank(water);
    BulletCoupling coupling(water, scene.world);
    coupling.add(cube);
    int fluid_steps = 0;
    coupling.attach([&](const StepReport& report) {
        ++fluid_steps;
        REQUIRE(report.converged);
    });
    int frames = 0;
    for (; frames * stepping.frame < 1.5; ++frames)
        scene.world.stepSimulation(static_cast<btScalar>(stepping.frame), stepping.sub_steps,
                                   static_cast<btScalar>(stepping.tick));
    CHECK(fluid_steps > 100);
    CHECK(water.time() == Approx(frames * stepping.frame).margin(1.1 * stepping.tick));
    // Half of it under water: the level rises by 0.0135 / (0.64 - 0.09) / 2 from 0.4 less what the cube displaced.
    const double level = water.level_at(0.1, 0.1).value_or(0.0);
    CHECK(height(cube) == Approx(level).margin(0.03)); // of 0.05 of spacing
    CHECK(cube.getTotalForce().isZero());
    CHECK_THROWS_AS(coupling.step(0.004), std::invalid_argument);
    coupling.detach();
    CHECK_NOTHROW(coupling.step(0.004));
}

TEST_CASE("bodies that the water does not touch move as Bullet alone moves them, bit for bit", "[bullet][riding]")
{
    const bool rides = GENERATE(false, true);
    BulletScene alone, coupled;
    FluidWorld water(coarse());
    if (GENERATE(false, true)) { // water elsewhere
        water.add_box_wall({Vec3d(9, 9, 0), Vec3d(9.4, 9.4, 0.4)}, {"+z"});
        water.add_block({Vec3d(9, 9, 0), Vec3d(9.4, 9.4, 0.2)});
    }
    BulletCoupling coupling(water, coupled.world);
    std::vector<btRigidBody*> bodies[2];
    int which = 0;
    for (BulletScene* scene : {&alone, &coupled}) {
        auto& ground = scene->shape<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
        scene->add({0, nullptr, &ground});
        for (int k = 0; k < 4; ++k) {
            btRigidBody& cube = add_cube(*scene, Vec3d(0.05 * k, 0, 0.3 + 0.35 * k), 5.0 + k);
            cube.setAngularVelocity(btVector3(btScalar(0.3), btScalar(-0.2), btScalar(k)));
            bodies[which].push_back(&cube);
        }
        ++which;
    }
    for (int k = 0; k < 3; ++k) coupling.add(*bodies[1][static_cast<std::size_t>(k)]); // one stays unknown
    if (rides) coupling.attach();
    for (int k = 0; k < 300; ++k) {
        double dt = 0.005;
        if (rides)
            coupled.world.stepSimulation(btScalar(dt), 0);
        else
            dt = coupling.step(dt).dt;
        alone.world.stepSimulation(btScalar(dt), 0);
        for (std::size_t body = 0; body < 4; ++body) REQUIRE(same_bits(*bodies[0][body], *bodies[1][body]));
    }
    CHECK(bodies[0][3]->getAngularVelocity().length() > btScalar(0)); // they fell, and rolled or slid
}

TEST_CASE("bodies are added, removed, put elsewhere and reshaped while the water is there", "[bullet][riding]")
{
    CoupledTank tank;
    auto& [scene, water, coupling] = tank;
    btRigidBody& first = tank.add(Vec3d(0.2, 0.2, 0.4));
    coupling.step_for(0.1);
    const std::size_t all = water.fluid().size();

    btRigidBody& second = add_cube(scene, Vec3d(0.6, 0.6, 0.2)); // in the water: it takes the place of 0.027 m^3
    CHECK(coupling.add(second) == 1);
    const StepReport added = coupling.step(0.004);
    const double displaced = added.removed_particles * std::pow(0.05, 3);
    CHECK(displaced == Approx(0.027).epsilon(0.25)); // 216 particles, those at its skin by chance
    CHECK(water.fluid().size() + static_cast<std::size_t>(added.removed_particles) == all);
    coupling.step_for(0.2);
    CHECK(coupling.bodies().size() == 2);
    CHECK(water.fluid_wrench(1).linear.z() > 0.0);
    CHECK(height(second) > 0.2); // it rises

    const std::size_t with_both = water.fluid().size();
    const std::size_t samples = water.boundary().size();
    btTransform elsewhere = first.getWorldTransform();
    elsewhere.setOrigin(btVector3(btScalar(0.2), btScalar(0.6), btScalar(0.25)));
    first.setWorldTransform(elsewhere); // into the water, away from both
    const StepReport jumped = coupling.step(0.004);
    CHECK(water.fluid().size() + static_cast<std::size_t>(jumped.removed_particles) == with_both);
    CHECK(jumped.removed_particles < 20); // most of it went to where the cube was
    CHECK(jumped.max_speed < 2.0);
    coupling.step_for(0.1);

    CHECK_THROWS_AS(coupling.reshape(scene.add_box(1.0, Vec3d(5, 5, 5))), std::invalid_argument);
    coupling.reshape(second, tessellate(BoxShape{Vec3d(0.2, 0.2, 0.2)}, 0.05));
    coupling.step(0.004);
    CHECK(water.boundary().size() < samples);

    coupling.remove(second);
    scene.world.removeRigidBody(&second);
    const double speed = coupling.step(0.004).max_speed;
    CHECK(speed < 2.0); // water falls into the hole
    CHECK(coupling.number_of(second) == -1);
    CHECK(coupling.number_of(first) == 0);
    CHECK_THROWS_AS(water.fluid_wrench(7), std::invalid_argument);
    CHECK_THROWS_AS(coupling.remove(second), std::invalid_argument);
    coupling.step_for(0.1);
    CHECK(height(first) > 0.2);        // and floats
    scene.world.addRigidBody(&second); // the scene takes it out again
}

TEST_CASE("a coupled body that was taken out of the Bullet world is refused by its number", "[bullet][riding]")
{
    CoupledTank tank;
    tank.add(Vec3d(0.2, 0.2, 0.4));
    btRigidBody& taken = tank.add(Vec3d(0.6, 0.6, 0.4));
    const bool rides = GENERATE(false, true);
    if (rides) tank.coupling.attach();
    const auto step = [&] { rides ? tank.scene.step(0.004) : static_cast<void>(tank.coupling.step(0.004)); };
    step();
    const double time = tank.water.time();
    tank.scene.world.removeRigidBody(&taken);
    CHECK_THROWS_AS(step(), std::invalid_argument);
    CHECK_THROWS_WITH(step(), Catch::Matchers::StartsWith("body 1 must be in the Bullet world"));
    CHECK(tank.water.time() == time);
    tank.scene.world.addRigidBody(&taken); // out and in again is fine
    CHECK_NOTHROW(step());
    tank.scene.world.removeRigidBody(&taken);
    tank.coupling.remove(taken); // late is better than never
    CHECK_NOTHROW(step());
    tank.scene.world.addRigidBody(&taken); // the scene takes it out again
}

TEST_CASE("nothing is added or removed while a step runs", "[bullet][riding]")
{
    CoupledTank tank;
    btRigidBody& cube = tank.add(Vec3d(0.4, 0.4, 0.4));
    int refused = 0;
    tank.coupling.attach([&](const StepReport&) {
        try {
            tank.coupling.remove(cube);
        } catch (const std::logic_error& error) {
            refused += std::string(error.what()).find("while a step runs") != std::string::npos ? 1 : 0;
        }
    });
    tank.scene.step(0.004);
    CHECK(refused >= 1);
    CHECK(tank.coupling.number_of(cube) == 0);
}

TEST_CASE("what a callback throws comes out of stepSimulation and ends the step", "[bullet][riding]")
{
    CoupledTank tank;
    btRigidBody& cube = tank.add(Vec3d(0.4, 0.4, 0.4));
    bool throws = true;
    tank.coupling.attach([&](const StepReport&) {
        if (throws) throw std::runtime_error("enough");
    });
    btRigidBody& falls = add_cube(tank.scene, Vec3d(5, 5, 5));
    CHECK_THROWS_WITH(tank.scene.step(0.004), "enough");
    throws = false;
    CHECK(falls.getTotalForce().isZero());
    CHECK_NOTHROW(tank.scene.step(0.004));
    CHECK(falls.getLinearVelocity().z() == Approx(-9.81 * 0.004)); // gravity of one step
    CHECK_NOTHROW(tank.coupling.remove(cube));
    CHECK(tank.coupling.number_of(cube) == -1);
}

TEST_CASE("one coupling only is attached to a world, two ride along by hand", "[bullet][riding]")
{
    CoupledTank tank;
    tank.add(Vec3d(0.4, 0.4, 0.4));
    FluidWorld other_water(coarse());
    BulletCoupling other(other_water, tank.scene.world);
    tank.coupling.attach();
    CHECK_THROWS_AS(tank.coupling.attach(), std::invalid_argument);
    CHECK_THROWS_AS(other.attach(), std::logic_error);
    CHECK_THROWS_WITH(other.attach(), Catch::Matchers::Contains("another coupling is attached"));
    tank.scene.step(0.004);
    CHECK(tank.water.time() == Approx(0.004));
    CHECK(other_water.time() == 0.0);
    tank.coupling.detach();
    other.attach();
    tank.scene.step(0.004);
    CHECK(other_water.time() == Approx(0.004));
    other.detach();

    BulletCoupling* both[] = {&tank.coupling, &other};
    const auto before = [](btDynamicsWorld* world, btScalar dt) {
        for (int k = 0; k < 2; ++k)
            static_cast<BulletCoupling**>(world->getWorldUserInfo())[k]->before_tick(static_cast<double>(dt));
    };
    const auto after = [](btDynamicsWorld* world, btScalar) {
        for (int k = 0; k < 2; ++k) static_cast<BulletCoupling**>(world->getWorldUserInfo())[k]->after_tick();
    };
    tank.scene.world.setInternalTickCallback(before, both, true);
    tank.scene.world.setInternalTickCallback(after, both, false);
    tank.scene.step(0.004);
    CHECK(tank.water.time() == Approx(0.008));
    CHECK(other_water.time() == Approx(0.008));
}

TEST_CASE("two waters and two Bullet worlds live side by side", "[bullet][riding]")
{
    CoupledTank tanks[2];
    for (CoupledTank& tank : tanks) tank.add(Vec3d(0.4, 0.4, 0.45));
    tanks[1].coupling.attach();
    for (int k = 0; k < 50; ++k) {
        const double dt = tanks[0].coupling.step(0.004).dt;
        tanks[1].scene.step(dt);
    }
    CHECK(tanks[0].water.time() == Approx(tanks[1].water.time()));
    CHECK(height(tanks[0].coupling.body(0)) ==
          Approx(height(tanks[1].coupling.body(0))).margin(1e-5)); // the same world twice, stepped in two ways
    CHECK(height(tanks[0].coupling.body(0)) < 0.449);
}
