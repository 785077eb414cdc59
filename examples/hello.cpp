// A box in a tank: it is half as heavy as water, falls in, and comes to rest with its middle at the water's level.
#include <cstdio>
#include <flotsam/bullet.hpp>

int main()
{
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity({0, 0, btScalar(-9.81)});
    btBoxShape shape({0.125, 0.125, 0.0625}); // half edges [m]
    btVector3 inertia;
    shape.calculateLocalInertia(3.90625, inertia);
    btRigidBody box(3.90625, nullptr, &shape, inertia); // [kg]: half of the water that its volume holds
    box.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), {0.25, 0.25, 0.375}));
    world.addRigidBody(&box);
    flotsam::FluidWorldSettings settings;
    settings.particle_spacing = 0.025; // [m]
    flotsam::FluidWorld water(settings);
    water.add_box_wall({{0, 0, 0}, {0.5, 0.5, 0.5}}, {"+z"});
    water.add_block({{0, 0, 0}, {0.5, 0.5, 0.25}});
    flotsam::BulletCoupling coupling(water, world);
    coupling.add(box);
    for (; water.time() < 2.0; coupling.step_for(0.1))
        std::printf("%.1f s: box at %.3f m, water at %.3f m\n", water.time(), double(box.getCenterOfMassPosition().z()),
                    water.level_at(0.05, 0.05).value_or(0.0));
    world.removeRigidBody(&box);
}
