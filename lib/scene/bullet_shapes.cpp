#include "scene/bullet_shapes.hpp"

#include "world/box_rooms.hpp"

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>

namespace flotsam::scene {
namespace {

/// Margins round corners off and lift bodies from each other; this much of the size is not seen.
constexpr double kMarginOfSize = 1e-3;

template <class BulletShape>
BulletShape* keep(std::unique_ptr<BulletShape> shape, double size, BulletShapes& into)
{
    shape->setMargin(to_scalar(kMarginOfSize * size));
    BulletShape* kept = shape.get();
    into.shapes.push_back(std::move(shape));
    return kept;
}

btTriangleMesh* add_triangles(const TriangleMesh& mesh, BulletShapes& into)
{
    auto triangles = std::make_unique<btTriangleMesh>();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        triangles->addTriangle(to_bullet(mesh.corner(t, 0)), to_bullet(mesh.corner(t, 1)),
                               to_bullet(mesh.corner(t, 2)));
    btTriangleMesh* kept = triangles.get();
    into.meshes.push_back(std::move(triangles));
    return kept;
}

/// Convex hull, its faces cut into triangles.
TriangleMesh convex_hull(const TriangleMesh& mesh)
{
    std::vector<double> coordinates;
    for (const Vec3d& v : mesh.vertices) coordinates.insert(coordinates.end(), v.data(), v.data() + 3);
    btConvexHullComputer computer;
    computer.compute(coordinates.data(), 3 * sizeof(double), static_cast<int>(mesh.vertices.size()), 0, 0);
    TriangleMesh hull;
    for (int k = 0; k < computer.vertices.size(); ++k) hull.vertices.push_back(from_bullet(computer.vertices[k]));
    for (int k = 0; k < computer.faces.size(); ++k) {
        const auto* const first = &computer.edges[computer.faces[k]];
        const int corner = first->getSourceVertex();
        for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != corner;
             edge = edge->getNextEdgeOfFace())
            hull.triangles.push_back({corner, edge->getSourceVertex(), edge->getTargetVertex()});
    }
    return hull;
}

btCollisionShape* add_mesh(const TriangleMesh& mesh, bool moves, BulletShapes& into)
{
    constexpr double kNearlyConvex = 1.02;
    const double size = bounds(mesh).size().maxCoeff();
    const TriangleMesh hull = convex_hull(mesh);
    if (std::abs(mass_properties(hull).volume) <= kNearlyConvex * mass_properties(mesh).volume) {
        auto shape = std::make_unique<btConvexHullShape>();
        for (const Vec3d& vertex : hull.vertices) shape->addPoint(to_bullet(vertex), false);
        shape->recalcLocalAabb();
        return keep(std::move(shape), size, into);
    }
    btTriangleMesh* triangles = add_triangles(mesh, into);
    if (!moves) return keep(std::make_unique<btBvhTriangleMeshShape>(triangles, true), size, into);
    auto* shape = keep(std::make_unique<btGImpactMeshShape>(triangles), size, into);
    shape->updateBound();
    return shape;
}

/// One shape per alternative of Shape, about its own origin.
struct AddPart {
    const Pose& pose;
    bool moves;
    BulletShapes& into;

    btCollisionShape* operator()(const BoxShape& box) const
    {
        return keep(std::make_unique<btBoxShape>(to_bullet(Vec3d(0.5 * box.edges))), box.edges.minCoeff(), into);
    }
    btCollisionShape* operator()(const SphereShape& sphere) const
    { // a sphere's margin is its radius
        into.shapes.push_back(std::make_unique<btSphereShape>(to_scalar(sphere.radius)));
        return into.shapes.back().get();
    }
    btCollisionShape* operator()(const CylinderShape& cylinder) const
    {
        const Vec3d half(cylinder.radius, cylinder.radius, 0.5 * cylinder.height);
        return keep(std::make_unique<btCylinderShapeZ>(to_bullet(half)), half.minCoeff(), into);
    }
    btCollisionShape* operator()(const DiscShape& disc) const
    {
        return keep(std::make_unique<btCylinderShape>(to_bullet(Vec3d(disc.radius, 0.5, disc.radius))), disc.radius,
                    into);
    }
    btCollisionShape* operator()(const MeshShape& mesh) const
    {
        return add_mesh(transformed(mesh.mesh, pose), moves, into); // GImpact shapes are happier without a parent
    }
};

bool is_identity(const Pose& pose)
{
    return pose.position.norm() < 1e-12 && pose.orientation.angularDistance(Quatd::Identity()) < 1e-12;
}

/// A slab behind one side of a box, reaching over its edges.
void add_slab(const Aabb& box, int axis, bool high, double thickness, btCompoundShape& compound, BulletShapes& into)
{
    Vec3d half = 0.5 * box.size() + Vec3d::Constant(thickness);
    half[axis] = 0.5 * thickness;
    Pose pose;
    pose.position = box.center();
    pose.position[axis] = high ? box.max[axis] + half[axis] : box.min[axis] - half[axis];
    btBoxShape* slab = keep(std::make_unique<btBoxShape>(to_bullet(half)), thickness, into);
    compound.addChildShape(to_bullet(pose), slab);
}

} // namespace

btVector3 to_bullet(const Vec3d& v)
{
    return {to_scalar(v.x()), to_scalar(v.y()), to_scalar(v.z())};
}

btQuaternion to_bullet(const Quatd& q)
{
    return {to_scalar(q.x()), to_scalar(q.y()), to_scalar(q.z()), to_scalar(q.w())};
}

btTransform to_bullet(const Pose& pose)
{
    return btTransform(to_bullet(pose.orientation), to_bullet(pose.position));
}

Vec3d from_bullet(const btVector3& v)
{
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

Pose from_bullet(const btTransform& transform)
{
    const btQuaternion q = transform.getRotation();
    return {from_bullet(transform.getOrigin()), Quatd(static_cast<double>(q.w()), static_cast<double>(q.x()),
                                                      static_cast<double>(q.y()), static_cast<double>(q.z()))
                                                    .normalized()};
}

btCollisionShape* add_body_shape(const PreparedBody& body, bool moves, BulletShapes& into)
{
    std::vector<std::pair<Pose, btCollisionShape*>> children;
    for (const PreparedPart& part : body.parts) {
        const bool is_mesh = std::holds_alternative<MeshShape>(part.shape);
        children.emplace_back(is_mesh ? Pose() : part.pose, std::visit(AddPart{part.pose, moves, into}, part.shape));
    }
    if (children.size() == 1 && is_identity(children.front().first)) return children.front().second;
    auto compound = std::make_unique<btCompoundShape>();
    for (const auto& [pose, shape] : children) compound->addChildShape(to_bullet(pose), shape);
    into.shapes.push_back(std::move(compound));
    return into.shapes.back().get();
}

btCollisionShape* add_wall_shape(const SceneWall& wall, const PreparedWall& prepared, double gap, BulletShapes& into)
{
    if (wall.mesh) {
        btTriangleMesh* triangles = add_triangles(prepared.mesh, into);
        const double size = bounds(prepared.mesh).size().maxCoeff();
        return keep(std::make_unique<btBvhTriangleMeshShape>(triangles, true), size, into);
    }
    const double thickness = std::min(0.1 * wall.box.size().maxCoeff(), gap);
    auto compound = std::make_unique<btCompoundShape>();
    const OpenSides open = open_sides(wall.open);
    for (int side = 0; side < 6; ++side)
        if (!open[static_cast<std::size_t>(side)])
            add_slab(wall.box, side / 2, side % 2 == 1, thickness, *compound, into);
    into.shapes.push_back(std::move(compound));
    return into.shapes.back().get();
}

} // namespace flotsam::scene
