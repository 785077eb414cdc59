#pragma once

#include "scene/prepared_scene.hpp"

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace flotsam::scene {

/// Collision shapes and the meshes under them: Bullet keeps pointers only.
struct BulletShapes {
    std::vector<std::unique_ptr<btStridingMeshInterface>> meshes;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
};

/// Collision shape of a body, in the body's frame. Box, sphere, cylinder and disc are Bullet's own; a mesh is its
/// convex hull if that is at most 2 % larger, else the mesh itself (for `moves`, GImpact).
btCollisionShape* add_body_shape(const PreparedBody& body, bool moves, BulletShapes& into);

/// Collision shape of a wall in the world: slabs behind the closed sides of a box, a tenth of it thick and no
/// thicker than the `gap` [m] to other tanks, which nothing tunnels through, or the triangles of a mesh.
btCollisionShape* add_wall_shape(const SceneWall& wall, const PreparedWall& prepared, double gap, BulletShapes& into);

[[nodiscard]] inline btScalar to_scalar(double value)
{
    return static_cast<btScalar>(value);
}
[[nodiscard]] btVector3 to_bullet(const Vec3d& v);
[[nodiscard]] btQuaternion to_bullet(const Quatd& q);
[[nodiscard]] btTransform to_bullet(const Pose& pose);
[[nodiscard]] Vec3d from_bullet(const btVector3& v);
[[nodiscard]] Pose from_bullet(const btTransform& transform);

} // namespace flotsam::scene
