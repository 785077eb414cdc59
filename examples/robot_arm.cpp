// A robot's arm of three links, a btMultiBody, is drawn through water by its motors, whose torques are printed.
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <cstdio>
#include <flotsam/bullet.hpp>
#include <memory>

int main()
{
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btMultiBodyConstraintSolver solver;
    btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity({0, 0, btScalar(-9.81)});
    btBoxShape shape({btScalar(0.04), btScalar(0.04), btScalar(0.075)}); // links of 0.15 m
    btVector3 inertia;
    shape.calculateLocalInertia(1, inertia);
    btMultiBody arm(3, 0, btVector3(1, 1, 1), true, false); // on a fixed base
    arm.setBasePos({btScalar(0.4), btScalar(0.25), btScalar(0.6)});
    const btVector3 axis(0, 1, 0), half(0, 0, btScalar(-0.075)), none(0, 0, 0);
    for (int k = 0; k < 3; ++k)
        arm.setupRevolute(k, 1, inertia, k - 1, btQuaternion::getIdentity(), axis, k > 0 ? half : none, half, true);
    arm.finalizeMultiDof();
    world.addMultiBody(&arm);
    std::unique_ptr<btMultiBodyLinkCollider> colliders[3];
    std::unique_ptr<btMultiBodyJointMotor> motors[3];
    for (int k = 0; k < 3; ++k) {
        colliders[k] = std::make_unique<btMultiBodyLinkCollider>(&arm, k);
        colliders[k]->setCollisionShape(&shape);
        arm.getLink(k).m_collider = colliders[k].get();
        world.addCollisionObject(colliders[k].get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter);
        motors[k] = std::make_unique<btMultiBodyJointMotor>(&arm, k, k == 0 ? btScalar(0.5) : 0, btScalar(1));
        world.addMultiBodyConstraint(motors[k].get()); // [rad/s], with an impulse of at most 1 N m s in a step
    }
    flotsam::FluidWorldSettings settings;
    settings.particle_spacing = 0.025;
    flotsam::FluidWorld water(settings);
    water.add_box_wall({{0, 0, 0}, {0.8, 0.5, 0.8}}, {"+z"});
    water.add_block({{0, 0, 0}, {0.8, 0.5, 0.45}});
    flotsam::BulletCoupling coupling(water, world);
    coupling.add(arm);
    for (double next = 0.0; water.time() < 1.0;) {
        const double dt = coupling.step(0.004).dt;
        if (water.time() < next) continue;
        next += 0.1;
        std::printf("%.1f s: shoulder at %5.1f deg; torques %6.2f %6.2f %6.2f N m\n", water.time(),
                    57.29578 * double(arm.getJointPos(0)), double(motors[0]->getAppliedImpulse(0)) / dt,
                    double(motors[1]->getAppliedImpulse(0)) / dt, double(motors[2]->getAppliedImpulse(0)) / dt);
    }
    for (auto& motor : motors) world.removeMultiBodyConstraint(motor.get());
    for (auto& collider : colliders) world.removeCollisionObject(collider.get());
    world.removeMultiBody(&arm);
}
