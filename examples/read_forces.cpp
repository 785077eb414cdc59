// Reads the force of the water on a ball that is held under it, and compares it with Archimedes.
#include <flotsam/bullet.hpp>

#include <cstdio>
#include <numbers>

int main()
{
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);

    const double radius = 0.125; // [m]
    btSphereShape shape{btScalar(radius)};
    btRigidBody ball(0, nullptr, &shape); // mass 0: Bullet does not move it
    ball.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), {0.25, 0.25, 0.25}));
    world.addRigidBody(&ball);

    flotsam::FluidWorldSettings settings;
    settings.particle_spacing = 0.025; // [m]
    flotsam::FluidWorld water(settings);
    water.add_box_wall({{0, 0, 0}, {0.5, 0.5, 0.75}}, {"+z"});
    water.add_block({{0, 0, 0}, {0.5, 0.5, 0.5}}); // what lies inside the ball is cut away
    flotsam::BulletCoupling coupling(water, world);
    const int number = coupling.add(ball);

    coupling.step_for(1.0); // the water settles
    flotsam::Vec3d impulse = flotsam::Vec3d::Zero();
    double seconds = 0.0;
    while (seconds < 0.5) {
        const flotsam::StepReport report = coupling.step(0.004);
        impulse += water.fluid_wrench(number).linear * report.dt; // forces are means over a step
        seconds += report.dt;
    }
    const flotsam::Vec3d force = impulse / seconds;
    const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    const double displaced_weight = water.settings().rest_density * volume * -water.settings().gravity.z();
    std::printf("force of the water     %8.2f %8.2f %8.2f N\n", force.x(), force.y(), force.z());
    std::printf("weight of its volume   %26.2f N\n", displaced_weight);
    std::printf("upward force / weight  %26.3f\n", force.z() / displaced_weight);
    world.removeRigidBody(&ball);
}
