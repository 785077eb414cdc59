#include "scene/scene_world.hpp"

#include "flotsam/core/contracts.hpp"
#include "scene/tanks.hpp"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>

#include <algorithm>
#include <limits>

namespace flotsam::scene {
namespace {

/// Bullet's default of 10 leaves joints of heavy bodies on light ones visibly open, and stacks creeping.
constexpr int kIterations = 50, kIterationsWithJoints = 1000;

FluidWorldSettings fluid_settings(const SceneFile& scene, int threads)
{
    FluidWorldSettings settings;
    settings.dimensions = scene.dimensions;
    settings.particle_spacing = scene.particle_spacing;
    settings.gravity = scene.gravity;
    settings.rest_density = scene.fluid.density;
    settings.kinematic_viscosity = scene.fluid.kinematic_viscosity;
    settings.kernel = scene.kernel;
    settings.pressure = scene.pressure;
    settings.start = scene.start;
    settings.max_time_step = scene.max_time_step;
    settings.cfl = scene.cfl;
    settings.threads = threads;
    return settings;
}

/// Locked axes, and those out of the plane in 2-D.
void lock_axes(const SceneBody& body, int dimensions, btRigidBody& made)
{
    Vec3d linear = Vec3d::Ones(), angular = Vec3d::Ones();
    for (int axis = 0; axis < 3; ++axis) {
        if (body.lock[static_cast<std::size_t>(axis)]) linear[axis] = 0.0;
        if (body.lock[static_cast<std::size_t>(axis + 3)]) angular[axis] = 0.0;
    }
    if (dimensions == 2) {
        linear.y() = 0.0;
        angular.x() = angular.z() = 0.0;
    }
    made.setLinearFactor(to_bullet(linear));
    made.setAngularFactor(to_bullet(angular));
}

std::unique_ptr<btRigidBody> rigid_body(double mass, const Vec3d& inertia, const Pose& pose, double friction,
                                        btCollisionShape* shape)
{
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, shape, to_bullet(inertia));
    info.m_startWorldTransform = to_bullet(pose);
    info.m_friction = static_cast<btScalar>(friction);
    return std::make_unique<btRigidBody>(info);
}

std::unique_ptr<btRigidBody> body_of(const SceneFile& scene, const SceneBody& body, const PreparedBody& prepared,
                                     btCollisionShape* shape)
{
    using Motion = SceneBody::Motion;
    const bool dynamic = body.motion == Motion::dynamic;
    auto made = rigid_body(dynamic ? prepared.mass : 0.0, dynamic ? prepared.inertia : Vec3d(Vec3d::Zero()),
                           prepared.start, body.friction, shape);
    if (body.motion == Motion::moving)
        made->setCollisionFlags(made->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    if (body.motion == Motion::fixed) return made;
    lock_axes(body, scene.dimensions, *made);
    made->setLinearVelocity(to_bullet(body.velocity));
    made->setAngularVelocity(to_bullet(body.angular_velocity));
    made->setActivationState(DISABLE_DEACTIVATION); // a floating body never rests for good
    return made;
}

} // namespace

SceneWorld::SceneWorld(const SceneFile& scene, const PreparedScene& prepared, int threads,
                       const std::function<void(const SettleProgress&)>& on_settle)
    : fluid_(fluid_settings(scene, threads)), dispatcher_(&configuration_),
      world_(&dispatcher_, &broadphase_, &solver_, &configuration_),
      coupling_(std::make_unique<BulletCoupling>(fluid_, world_))
{
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    world_.setGravity(to_bullet(scene.gravity));
    world_.getSolverInfo().m_numIterations = kIterations;
    // With Bullet's one direction of friction a stack that is nudged creeps by millimetres a second.
    world_.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    add_fluid(prepared);
    for (std::size_t k = 0; k < scene.fluid.meshes.size(); ++k)
        fluid_.add_fluid_mesh(prepared.fluid_meshes[k], scene.fluid.meshes[k].velocity);
    add_walls(scene, prepared);
    add_bodies(scene, prepared);
    add_joints(scene);
    world_.performDiscreteCollisionDetection(); // so that the first step knows what lies on what
    fluid_.prepare(coupling_->bodies(), on_settle);
    if (fluid_.fluid().size() == 0)
        throw InputError(scene.file.string() + ": no fluid is left within the walls and outside the bodies");
}

SceneWorld::~SceneWorld()
{
    coupling_.reset();
    joints_.clear();
    for (const Body& body : bodies_)
        if (body.rigid) world_.removeRigidBody(body.rigid.get());
    articulations_.clear();
    for (const auto& wall : walls_) world_.removeRigidBody(wall.get());
}

void SceneWorld::add_fluid(const PreparedScene& prepared)
{
    for (const SceneBlock& block : prepared.blocks) fluid_.add_block(block.box, block.velocity);
}

void SceneWorld::add_walls(const SceneFile& scene, const PreparedScene& prepared)
{
    for (std::size_t k = 0; k < scene.walls.size(); ++k) {
        const SceneWall& wall = scene.walls[k];
        const int number =
            wall.mesh ? fluid_.add_wall(prepared.walls[k].mesh, wall.side) : fluid_.add_box_wall(wall.box, wall.open);
        fluid_.name_wall(number, prepared.walls[k].name);
        double gap = std::numeric_limits<double>::infinity(); // to other tanks
        for (std::size_t other = 0; other < scene.walls.size(); ++other)
            gap = std::min(gap, gap_of_tanks(scene, k, other).value_or(gap));
        // Bullet multiplies frictions: 1 leaves a body's own against walls
        walls_.push_back(
            rigid_body(0.0, Vec3d::Zero(), Pose(), 1.0, add_wall_shape(wall, prepared.walls[k], gap, shapes_)));
        world_.addRigidBody(walls_.back().get());
    }
}

void SceneWorld::add_bodies(const SceneFile& scene, const PreparedScene& prepared)
{
    std::vector<btCollisionShape*> shapes;
    for (std::size_t k = 0; k < scene.bodies.size(); ++k)
        shapes.push_back(
            add_body_shape(prepared.bodies[k], scene.bodies[k].motion == SceneBody::Motion::dynamic, shapes_));
    bodies_.resize(scene.bodies.size());
    joints_.resize(scene.joints.size());
    for (const SceneArticulation& articulation : scene.articulations) {
        articulations_.push_back(std::make_unique<Articulation>(scene, articulation, prepared, shapes, world_));
        Articulation* made = articulations_.back().get();
        for (std::size_t link = 0; link < made->size(); ++link) {
            bodies_[made->body(link)].link = {made, link};
            if (const auto joint = made->joint(link)) joints_[*joint].link = {made, link};
        }
    }
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
        const PreparedBody& from = prepared.bodies[k];
        const auto [articulation, link] = bodies_[k].link;
        if (articulation == nullptr) {
            bodies_[k].rigid = body_of(scene, scene.bodies[k], from, shapes[k]);
            world_.addRigidBody(bodies_[k].rigid.get());
        }
        const int number = articulation == nullptr ? coupling_->add(*bodies_[k].rigid, from.mesh)
                                                   : coupling_->add(articulation->collider(link), from.mesh);
        fluid_.name_body(number, from.name);
    }
}

void SceneWorld::add_joints(const SceneFile& scene)
{
    if (!scene.joints.empty()) world_.getSolverInfo().m_numIterations = kIterationsWithJoints;
    for (std::size_t k = 0; k < scene.joints.size(); ++k) {
        if (joints_[k].link.articulation != nullptr) continue;
        if (!ground_) ground_ = rigid_body(0.0, Vec3d::Zero(), Pose(), 0.0, nullptr);
        const SceneJoint& joint = scene.joints[k];
        joints_[k].constraint = std::make_unique<BulletJoint>(joint, *bodies_[joint.a].rigid,
                                                              joint.b ? *bodies_[*joint.b].rigid : *ground_, world_);
    }
}

StepReport SceneWorld::step(double dt)
{
    for (const auto& articulation : articulations_) articulation->begin_step(dt);
    const StepReport report = coupling_->step(dt);
    for (const auto& articulation : articulations_) articulation->end_step(fluid_, report.dt);
    for (const Joint& joint : joints_)
        if (joint.constraint) joint.constraint->update();
    return report;
}

BodyNow SceneWorld::body(std::size_t k) const
{
    const auto [articulation, link] = bodies_[k].link;
    if (articulation != nullptr) return {articulation->pose(link), articulation->twist(link)};
    const btRigidBody& body = *bodies_[k].rigid;
    return {from_bullet(body.getWorldTransform()),
            {from_bullet(body.getLinearVelocity()), from_bullet(body.getAngularVelocity())}};
}

std::vector<BodyState> SceneWorld::body_states() const
{
    std::vector<BodyState> states;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const BodyNow now = body(k);
        const bool responds = !bodies_[k].rigid || !bodies_[k].rigid->isStaticOrKinematicObject();
        states.push_back({now.pose, now.twist, responds});
    }
    return states;
}

const JointNow& SceneWorld::joint(std::size_t k) const
{
    const auto [articulation, link] = joints_[k].link;
    return articulation != nullptr ? articulation->joint_now(link) : joints_[k].constraint->now();
}

} // namespace flotsam::scene
