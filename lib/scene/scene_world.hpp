#pragma once

#include "flotsam/bullet/bullet_coupling.hpp"
#include "scene/articulation.hpp"
#include "scene/bullet_joint.hpp"
#include "scene/bullet_shapes.hpp"
#include "scene/prepared_scene.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include <functional>
#include <memory>
#include <vector>

namespace flotsam::scene {

/// Where a body of the scene is now.
struct BodyNow {
    Pose pose; ///< of the body's frame
    Twist twist;
};

/// The fluid and the Bullet world of a scene, coupled.
class SceneWorld {
  public:
    /// `on_settle`: as FluidWorld::prepare takes it.
    SceneWorld(const SceneFile& scene, const PreparedScene& prepared, int threads,
               const std::function<void(const SettleProgress&)>& on_settle = {});
    ~SceneWorld();
    SceneWorld(const SceneWorld&) = delete;
    SceneWorld& operator=(const SceneWorld&) = delete;

    [[nodiscard]] const FluidWorld& fluid() const { return fluid_; }
    [[nodiscard]] std::size_t body_count() const { return bodies_.size(); }
    [[nodiscard]] BodyNow body(std::size_t k) const;
    /// Of all bodies, as FluidWorld::waterline wants them.
    [[nodiscard]] std::vector<BodyState> body_states() const;

    [[nodiscard]] const JointNow& joint(std::size_t k) const;

    StepReport step(double dt);

  private:
    struct InArticulation {
        Articulation* articulation = nullptr;
        std::size_t link = 0;
    };
    struct Body {
        std::unique_ptr<btRigidBody> rigid; ///< null: a link
        InArticulation link;
    };
    struct Joint {
        std::unique_ptr<BulletJoint> constraint; ///< null: that of a link
        InArticulation link;
    };
    void add_fluid(const PreparedScene& prepared);
    void add_walls(const SceneFile& scene, const PreparedScene& prepared);
    void add_bodies(const SceneFile& scene, const PreparedScene& prepared);
    void add_joints(const SceneFile& scene);

    FluidWorld fluid_;
    BulletShapes shapes_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btMultiBodyConstraintSolver solver_;
    btMultiBodyDynamicsWorld world_;
    std::unique_ptr<btRigidBody> ground_; ///< what joints to the world hold on to; not in world_
    std::vector<std::unique_ptr<btRigidBody>> walls_;
    std::vector<std::unique_ptr<Articulation>> articulations_;
    std::vector<Body> bodies_;
    std::vector<Joint> joints_;
    std::unique_ptr<BulletCoupling> coupling_;
};

} // namespace flotsam::scene
