// An application that owns its Bullet world and steps it as it always did: the water rides along.
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
    btBoxShape shape({btScalar(0.15), btScalar(0.1), btScalar(0.05)});
    btVector3 inertia;
    shape.calculateLocalInertia(2, inertia);
    btRigidBody raft(2, nullptr, &shape, inertia), load(1, nullptr, &shape, inertia); // [kg]
    raft.setCenterOfMassTransform({btQuaternion::getIdentity(), {btScalar(0.4), btScalar(0.3), btScalar(0.3)}});
    load.setCenterOfMassTransform({btQuaternion::getIdentity(), {btScalar(0.4), btScalar(0.3), btScalar(0.42)}});
    world.addRigidBody(&raft);
    world.addRigidBody(&load);

    flotsam::FluidWorldSettings settings;
    settings.particle_spacing = 0.03;
    flotsam::FluidWorld water(settings);
    water.add_box_wall({{0, 0, 0}, {0.8, 0.6, 0.6}}, {"+z"});
    water.add_block({{0, 0, 0}, {0.8, 0.6, 0.24}});
    flotsam::BulletCoupling coupling(water, world);
    coupling.add(raft); // the water does not know the load, which lies on the raft
    coupling.attach();
    for (int frame = 0; frame <= 90; ++frame) {
        if (frame % 15 == 0)
            std::printf("%.2f s: raft at %.3f m, load at %.3f m, water at %.3f m, it lifts with %.1f N\n", water.time(),
                        double(raft.getCenterOfMassPosition().z()), double(load.getCenterOfMassPosition().z()),
                        water.level_at(0.1, 0.1).value_or(0.0),
                        frame > 0 ? water.fluid_wrench(coupling.number_of(raft)).linear.z() : 0.0);
        world.stepSimulation(btScalar(1.0 / 60), 4, btScalar(1.0 / 240));
    }
    coupling.detach();
    world.removeRigidBody(&load);
    world.removeRigidBody(&raft);
}
