// Half as dense as water, a box must come to rest with its middle at the water's level.

#include <flotsam/bullet.hpp>

#include <cmath>
#include <cstdio>

int main()
{
    constexpr double width = 0.2, height = 0.1, density = 500.0; // in the plane y = 0, one metre long [m], [kg/m^3]
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity(btVector3(0, 0, -9.81));

    btBoxShape shape(btVector3(0.5 * width, 0.5, 0.5 * height));
    const double mass = density * width * height;
    btVector3 inertia;
    shape.calculateLocalInertia(mass, inertia);
    btRigidBody box(mass, nullptr, &shape, inertia);
    box.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0.3, 0, 0.28)));
    box.setLinearFactor(btVector3(1, 0, 1));
    box.setAngularFactor(btVector3(0, 1, 0));
    world.addRigidBody(&box);

    flotsam::FluidWorldSettings settings;
    settings.dimensions = 2;
    settings.particle_spacing = 0.0125;
    flotsam::FluidWorld water(settings);
    water.add_box_wall({{0, -0.5, 0}, {0.6, 0.5, 0.5}}, {"+z"});
    water.add_block({{0, -0.5, 0}, {0.6, 0.5, 0.25}});

    flotsam::BulletCoupling coupling(water, world);
    coupling.add(box);
    coupling.step_for(1.5);

    const double level = water.level_at(0.05, 0.0).value_or(0.0);
    const double middle = box.getWorldTransform().getOrigin().z();
    std::printf("level %.4f m, middle of the box %.4f m\n", level, middle);
    return level > 0.25 && std::abs(middle - level) < 2.0 * settings.particle_spacing ? 0 : 1;
}
