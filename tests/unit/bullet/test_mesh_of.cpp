#include "bullet_scene.hpp"
#include "flotsam/bullet/bullet_coupling.hpp"
#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "support/catch.hpp"

#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btUniformScalingShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <map>
#include <numbers>

using namespace flotsam;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdge = 0.05;
constexpr double kExact = sizeof(btScalar) == 8 ? 1e-9 : 1e-5; ///< relative, Bullet's rounding

btVector3 vector(double x, double y, double z)
{
    return to_bullet(Vec3d(x, y, z));
}

btScalar scalar(double x)
{
    return static_cast<btScalar>(x);
}

/// Every edge is used once in each direction.
bool is_closed(const TriangleMesh& mesh)
{
    std::map<std::pair<int, int>, int> uses;
    for (const auto& triangle : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++uses[{triangle[k], triangle[(k + 1) % 3]}];
    for (const auto& [edge, count] : uses)
        if (count != 1 || !uses.contains({edge.second, edge.first})) return false;
    return !mesh.empty();
}

void check_solid(const btCollisionShape& shape, double volume, const Vec3d& size)
{
    const TriangleMesh mesh = mesh_of(shape, kEdge);
    INFO(shape.getName());
    CHECK(is_closed(mesh));
    const MassProperties solid = mass_properties(mesh);
    CHECK(solid.volume == Approx(volume).epsilon(kExact));
    CHECK((bounds(mesh).size() - size).norm() < 0.02 * size.norm()); // round shapes are a few 0.1 % larger or smaller
}

/// A box of edges 0.2, 0.3, 0.5 m about (1, 0, 0) as triangles, shifted so that its inside is not at the origin.
struct BoxTriangles {
    std::unique_ptr<btTriangleMesh> mesh = std::make_unique<btTriangleMesh>();
    explicit BoxTriangles(bool closed = true)
    {
        btBoxShape box(vector(0.1, 0.15, 0.25));
        const TriangleMesh surface = mesh_of(box, 1.0);
        for (std::size_t t = closed ? 0 : 1; t < surface.triangles.size(); ++t) {
            btVector3 corner[3];
            for (int k = 0; k < 3; ++k) corner[k] = to_bullet(surface.corner(t, k) + Vec3d(1, 0, 0));
            mesh->addTriangle(corner[0], corner[1], corner[2]);
        }
    }
};

} // namespace

TEST_CASE("primitive shapes become closed meshes of their volume", "[bullet][mesh_of]")
{
    const double r = 0.2, h = 0.6;
    const double cylinder = kPi * r * r * h, cone = cylinder / 3.0, ball = 4.0 / 3.0 * kPi * r * r * r;
    const double l = h + 2 * r; // of a capsule
    check_solid(btBoxShape(vector(0.1, 0.15, 0.25)), 0.2 * 0.3 * 0.5, {0.2, 0.3, 0.5});
    check_solid(btSphereShape(scalar(r)), ball, {2 * r, 2 * r, 2 * r});
    check_solid(btCylinderShapeX(vector(h / 2, r, r)), cylinder, {h, 2 * r, 2 * r});
    check_solid(btCylinderShape(vector(r, h / 2, r)), cylinder, {2 * r, h, 2 * r});
    check_solid(btCylinderShapeZ(vector(r, r, h / 2)), cylinder, {2 * r, 2 * r, h});
    check_solid(btCapsuleShapeX(scalar(r), scalar(h)), cylinder + ball, {l, 2 * r, 2 * r});
    check_solid(btCapsuleShape(scalar(r), scalar(h)), cylinder + ball, {2 * r, l, 2 * r});
    check_solid(btCapsuleShapeZ(scalar(r), scalar(h)), cylinder + ball, {2 * r, 2 * r, l});
    check_solid(btCapsuleShape(scalar(r), scalar(0)), ball, {2 * r, 2 * r, 2 * r});
    check_solid(btConeShapeX(scalar(r), scalar(h)), cone, {h, 2 * r, 2 * r});
    check_solid(btConeShape(scalar(r), scalar(h)), cone, {2 * r, h, 2 * r});
    check_solid(btConeShapeZ(scalar(r), scalar(h)), cone, {2 * r, 2 * r, h});
}

TEST_CASE("a cone's tip points along its axis and its middle is at half its height", "[bullet][mesh_of]")
{
    const double h = 0.6;
    const TriangleMesh mesh = mesh_of(btConeShapeZ(scalar(0.2), scalar(h)), kEdge);
    CHECK(bounds(mesh).max.z() == Approx(h / 2));
    CHECK(mass_properties(mesh).center_of_mass.z() == Approx(-h / 4).epsilon(0.01));
}

TEST_CASE("margins are not part of the mesh but scaling is", "[bullet][mesh_of]")
{
    btBoxShape box(vector(0.1, 0.15, 0.25));
    box.setMargin(scalar(0.07));
    check_solid(box, 0.03, {0.2, 0.3, 0.5});
    box.setLocalScaling(vector(2, 3, 4));
    check_solid(box, 24 * 0.03, {0.4, 0.9, 2.0});
    btBoxShape child(vector(0.1, 0.15, 0.25));
    check_solid(btUniformScalingShape(&child, scalar(0.5)), 0.03 / 8, {0.1, 0.15, 0.25});
}

TEST_CASE("convex shapes become the hull of their points", "[bullet][mesh_of]")
{
    std::vector<btVector3> points; // an octahedron of volume 4/3 and points inside
    for (int axis = 0; axis < 3; ++axis)
        for (const int sign : {-1, 1}) {
            btVector3 tip(0, 0, 0);
            tip[axis] = scalar(sign);
            points.push_back(tip);
            points.push_back(tip * scalar(0.3));
        }
    const int count = static_cast<int>(points.size());
    btConvexHullShape hull(&points[0].x(), count);
    hull.setMargin(scalar(0.2));
    check_solid(hull, 4.0 / 3.0, {2, 2, 2});
    hull.setLocalScaling(vector(1, 2, 3));
    check_solid(hull, 8.0, {2, 4, 6});
    check_solid(btConvexPointCloudShape(points.data(), count, vector(1, 1, 2)), 8.0 / 3.0, {2, 2, 4});
    btConvexHullShape box;
    for (int corner = 0; corner < 8; ++corner)
        box.addPoint(vector(corner & 1, (corner >> 1) & 1, 2 * ((corner >> 2) & 1)));
    check_solid(box, 2.0, {1, 1, 2});
    const BoxTriangles triangles;
    triangles.mesh->setScaling(vector(1, 1, 2));
    check_solid(btConvexTriangleMeshShape(triangles.mesh.get()), 0.06, {0.2, 0.3, 1.0});
    CHECK_THROWS_AS(mesh_of(btConvexHullShape(&points[0].x(), 3), kEdge), std::invalid_argument);
}

TEST_CASE("triangle meshes come as they are, welded", "[bullet][mesh_of]")
{
    const BoxTriangles triangles;
    btBvhTriangleMeshShape bvh(triangles.mesh.get(), GENERATE(false, true));
    check_solid(bvh, 0.03, {0.2, 0.3, 0.5});
    CHECK(mesh_of(bvh, kEdge).vertices.size() == 8);
    CHECK((mass_properties(mesh_of(bvh, kEdge)).center_of_mass - Vec3d(1, 0, 0)).norm() < 1e-6);
    check_solid(btScaledBvhTriangleMeshShape(&bvh, vector(2, 2, 2)), 0.24, {0.4, 0.6, 1.0});
    btGImpactMeshShape gimpact(triangles.mesh.get());
    gimpact.setLocalScaling(vector(1, 1, 2));
    gimpact.updateBound();
    check_solid(gimpact, 0.06, {0.2, 0.3, 1.0});
}

TEST_CASE("an open triangle mesh is refused by name", "[bullet][mesh_of]")
{
    const BoxTriangles open(false);
    CHECK_THROWS_WITH(mesh_of(btBvhTriangleMeshShape(open.mesh.get(), true), kEdge),
                      Catch::Matchers::Contains("BVHTRIANGLEMESH"));
}

TEST_CASE("compounds are their children where they are", "[bullet][mesh_of]")
{
    btBoxShape box(vector(0.1, 0.1, 0.1));
    btSphereShape sphere(scalar(0.1));
    btCompoundShape inner, outer;
    inner.addChildShape(btTransform(btQuaternion(vector(0, 0, 1), scalar(kPi / 4)), vector(1, 0, 0)), &box);
    inner.addChildShape(btTransform(btQuaternion::getIdentity(), vector(0, 0, 0)), &sphere);
    outer.addChildShape(btTransform(btQuaternion(vector(0, 0, 1), scalar(kPi / 2)), vector(0, 0, 1)), &inner);
    const TriangleMesh mesh = mesh_of(outer, kEdge);
    const double ball = 4.0 / 3.0 * kPi * 1e-3, cube = 8e-3;
    const MassProperties solid = mass_properties(mesh);
    CHECK(is_closed(mesh));
    CHECK(solid.volume == Approx(ball + cube).epsilon(1e-6));
    CHECK((solid.center_of_mass - Vec3d(0, cube / (ball + cube), 1)).norm() < 1e-5);
    CHECK(bounds(mesh).max.y() == Approx(1.0 + 0.1 * std::sqrt(2.0)));
}

TEST_CASE("shapes without a closed surface are refused by name", "[bullet][mesh_of]")
{
    const btScalar heights[] = {0, 0, 0, 0};
    const btVector3 centers[] = {vector(0, 0, 0), vector(1, 0, 0)};
    const btScalar radii[] = {1, 1};
    const auto refused = [](const btCollisionShape& shape) {
        CHECK_THROWS_WITH(mesh_of(shape, kEdge), Catch::Matchers::Contains(shape.getName()));
        CHECK_THROWS_AS(mesh_of(shape, kEdge), std::invalid_argument);
    };
    refused(btStaticPlaneShape(vector(0, 0, 1), 0));
    refused(btEmptyShape());
    refused(btMultiSphereShape(centers, radii, 2));
    refused(btHeightfieldTerrainShape(2, 2, heights, scalar(0), scalar(1), 2, false));
    btStaticPlaneShape plane(vector(0, 0, 1), 0);
    btCompoundShape compound;
    CHECK_THROWS_AS(mesh_of(compound, kEdge), std::invalid_argument); // empty
    compound.addChildShape(btTransform::getIdentity(), &plane);
    CHECK_THROWS_WITH(mesh_of(compound, kEdge), Catch::Matchers::Contains("STATICPLANE"));
    CHECK_THROWS_AS(mesh_of(btBoxShape(vector(1, 1, 1)), 0.0), std::invalid_argument);
}
