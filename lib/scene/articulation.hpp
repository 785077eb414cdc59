#pragma once

#include "bullet/multibody_kinematics.hpp"
#include "scene/bullet_joint.hpp"
#include "scene/bullet_shapes.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <memory>
#include <optional>
#include <vector>

namespace flotsam::scene {

/// An articulation of the scene in its Bullet world: a btMultiBody whose base is the world (fixed, without a shape) or
/// the body that hangs from no other, and whose links are the bodies that joints hold. Its joints cannot come open.
class Articulation {
  public:
    /// The bodies are where the scene starts, and move as far as their joints let them. `shapes` are those of all
    /// bodies of the scene.
    Articulation(const SceneFile& scene, const SceneArticulation& articulation, const PreparedScene& prepared,
                 const std::vector<btCollisionShape*>& shapes, btMultiBodyDynamicsWorld& world);
    ~Articulation();
    Articulation(const Articulation&) = delete;
    Articulation& operator=(const Articulation&) = delete;

    /// Numbers of the scene's bodies, in the order of links; that of `link`'s joint, if it has one.
    [[nodiscard]] std::size_t size() const { return links_.size(); }
    [[nodiscard]] std::size_t body(std::size_t link) const { return links_[link].body; }
    [[nodiscard]] std::optional<std::size_t> joint(std::size_t link) const { return links_[link].joint; }

    [[nodiscard]] btMultiBodyLinkCollider& collider(std::size_t link) { return *links_[link].collider; }
    [[nodiscard]] Pose pose(std::size_t link) const { return kinematics_.pose(links_[link].number + 1); }
    [[nodiscard]] Twist twist(std::size_t link) const;
    [[nodiscard]] const JointNow& joint_now(std::size_t link) const { return links_[link].now; }

    /// Before each step of the world, of `dt` seconds, and after it. The loads of joints are what the momenta of the
    /// links ask for: Bullet's own (btMultiBodyJointFeedback) have no motor and no limit, and too much where it moves.
    void begin_step(double dt);
    void end_step(const FluidWorld& fluid, double dt);

  private:
    struct Link {
        std::size_t body = 0;              ///< of the scene, and of the fluid
        int number = -1;                   ///< Bullet's; -1: the base
        std::optional<std::size_t> joint;  ///< of the scene; none: the base
        std::optional<std::size_t> parent; ///< place in links_; none: the world
        SceneJoint of;                     ///< its joint, if it has one
        std::unique_ptr<btMultiBodyLinkCollider> collider;
        std::unique_ptr<btMultiBodyConstraint> limit;
        std::unique_ptr<btMultiBodyJointMotor> motor;
        Vec3d center, pivot; ///< as the step began [m]
        Wrench before;       ///< momentum as the step began, about `center`
        Wrench load;         ///< of the last step, with all that hangs from it, about the world's origin
        JointNow now;
    };
    [[nodiscard]] std::optional<std::size_t> link_of(std::optional<std::size_t> body) const;
    void add_base(const SceneFile& scene, const SceneArticulation& articulation, const PreparedScene& prepared);
    void add_link(const SceneFile& scene, std::size_t joint, const PreparedScene& prepared);
    void add_drives(Link& link);
    void start_moving(const SceneFile& scene);
    void update();
    [[nodiscard]] Wrench momentum(const Link& link) const;
    [[nodiscard]] Wrench own_load(const Link& link, const FluidWorld& fluid, double dt) const;
    [[nodiscard]] double position(const Link& link) const;

    btMultiBodyDynamicsWorld& world_;
    std::unique_ptr<btMultiBody> body_;
    std::vector<Link> links_;
    MultibodyKinematics kinematics_;
    Eigen::VectorXd velocity_; ///< in joint space
};

} // namespace flotsam::scene
