// A hull from a mesh file in a Bullet world that the application has already: the world keeps its own bodies, contacts
// and joints, and the water only moves what is coupled with it.
#include <flotsam/bullet.hpp>

#include <cstdio>

/// The application's world: here a floor and a crate that has nothing to do with the water.
struct Application {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    btStaticPlaneShape floor_shape{{0, 0, 1}, 0};
    btBoxShape crate_shape{{0.125, 0.125, 0.125}};
    btRigidBody floor{0, nullptr, &floor_shape}, crate{1, nullptr, &crate_shape, {0.0625, 0.0625, 0.0625}};

    Application()
    {
        world.setGravity({0, 0, btScalar(-9.81)});
        crate.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), {2, 0, 0.5}));
        world.addRigidBody(&floor);
        world.addRigidBody(&crate);
    }
};

btVector3 to_bullet(const flotsam::Vec3d& v)
{
    return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

int main()
{
    flotsam::TriangleMesh hull = flotsam::load_mesh(FLOTSAM_DATA_DIR "/meshes/hull.obj");
    flotsam::check_mesh(hull); // welds it, or says in a sentence what is wrong with it
    const flotsam::MassProperties solid = flotsam::mass_properties(hull);
    for (flotsam::Vec3d& vertex : hull.vertices) vertex -= solid.center_of_mass; // Bullet's origin of a body

    Application application;
    btConvexHullShape shape; // for contacts; the water meets the mesh itself
    for (const flotsam::Vec3d& vertex : hull.vertices) shape.addPoint(to_bullet(vertex));
    const double density = 400.0; // [kg/m^3]
    btRigidBody body(btScalar(density * solid.volume), nullptr, &shape, to_bullet(density * solid.inertia.diagonal()));
    body.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), {0, 0, btScalar(0.2)}));
    application.world.addRigidBody(&body);

    flotsam::FluidWorldSettings settings;
    settings.particle_spacing = 0.02; // [m]
    flotsam::FluidWorld water(settings);
    water.add_box_wall({{-0.4, -0.2, 0}, {0.4, 0.2, 0.4}}, {"+z"});
    water.add_block({{-0.4, -0.2, 0}, {0.4, 0.2, 0.16}});
    flotsam::BulletCoupling coupling(water, application.world);
    coupling.add(body, hull);
    for (; water.time() < 1.5; coupling.step_for(0.1))
        std::printf("%.1f s: hull at %.3f m, crate at %.3f m\n", water.time(),
                    double(body.getCenterOfMassPosition().z()),
                    double(application.crate.getCenterOfMassPosition().z()));
    application.world.removeRigidBody(&body);
}
