#include "bullet/convert.hpp"
#include "bullet/revolve.hpp"
#include "flotsam/bullet/bullet_coupling.hpp"
#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "flotsam/geometry/shapes.hpp"

#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace flotsam {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kFewestSegments = 24; ///< around a round shape, however long the edges may be

int pieces(double length, double max_edge, int at_least = 1)
{
    return std::max(at_least, static_cast<int>(std::ceil(length / max_edge)));
}

/// A mesh about the z axis turned to `axis` (0, 1, 2) by a cyclic exchange of coordinates, which keeps its handedness.
TriangleMesh along_axis(TriangleMesh mesh, int axis)
{
    for (Vec3d& v : mesh.vertices) {
        if (axis == 0) v = Vec3d(v.z(), v.x(), v.y());
        if (axis == 1) v = Vec3d(v.y(), v.z(), v.x());
    }
    return mesh;
}

TriangleMesh box(const btBoxShape& shape, double max_edge)
{
    return tessellate(BoxShape{2.0 * from_bullet(shape.getHalfExtentsWithMargin())}, max_edge);
}

TriangleMesh sphere(const btSphereShape& shape, double max_edge)
{
    return tessellate(SphereShape{static_cast<double>(shape.getRadius())}, max_edge);
}

TriangleMesh cylinder(const btCylinderShape& shape, double max_edge)
{
    const double height = 2.0 * from_bullet(shape.getHalfExtentsWithMargin())[shape.getUpAxis()];
    return along_axis(tessellate(CylinderShape{static_cast<double>(shape.getRadius()), height}, max_edge),
                      shape.getUpAxis());
}

TriangleMesh capsule(const btCapsuleShape& shape, double max_edge)
{
    const double r = static_cast<double>(shape.getRadius()), half = static_cast<double>(shape.getHalfHeight());
    const int arcs = pieces(0.5 * kPi * r, max_edge, kFewestSegments / 4);
    const int rows = pieces(2.0 * half, max_edge);
    std::vector<ProfilePoint> profile;
    for (int k = 0; k <= arcs; ++k) {
        const double angle = 0.5 * kPi * k / arcs;
        profile.push_back({r * std::sin(angle), -half - r * std::cos(angle)});
    }
    for (int k = 1; k < rows; ++k) profile.push_back({r, half * (2.0 * k / rows - 1.0)});
    const int first = half > 0.0 ? arcs : arcs - 1; // a capsule without a straight part has one equator
    for (int k = first; k >= 0; --k) {
        const ProfilePoint below = profile[static_cast<std::size_t>(k)];
        profile.push_back({below.radius, -below.z});
    }
    const double volume = kPi * r * r * (2.0 * half + 4.0 / 3.0 * r);
    return along_axis(revolved(profile, pieces(2.0 * kPi * r, max_edge, kFewestSegments), volume), shape.getUpAxis());
}

TriangleMesh cone(const btConeShape& shape, double max_edge)
{
    const double r = static_cast<double>(shape.getRadius()), height = static_cast<double>(shape.getHeight());
    const int rings = pieces(r, max_edge, 2), rows = pieces(std::hypot(r, height), max_edge, 2);
    std::vector<ProfilePoint> profile;
    for (int k = 0; k < rings; ++k) profile.push_back({r * k / rings, -0.5 * height});
    for (int k = 0; k <= rows; ++k) profile.push_back({r * (rows - k) / rows, height * k / rows - 0.5 * height});
    return along_axis(revolved(profile, pieces(2.0 * kPi * r, max_edge, kFewestSegments), kPi * r * r * height / 3.0),
                      shape.getConeUpIndex());
}

/// The polygons of a convex hull as fans of triangles. The hull computer works on rounded coordinates; its vertices
/// are put back to the points that they came from.
TriangleMesh hull_of(const std::vector<Vec3d>& points)
{
    TriangleMesh mesh;
    btConvexHullComputer hull;
    hull.compute(points.front().data(), sizeof(Vec3d), static_cast<int>(points.size()), 0, 0);
    for (int v = 0; v < hull.vertices.size(); ++v)
        mesh.vertices.push_back(points[static_cast<std::size_t>(hull.original_vertex_index[v])]);
    for (int f = 0; f < hull.faces.size(); ++f) {
        const auto* edge = &hull.edges[hull.faces[f]];
        const int apex = edge->getSourceVertex();
        for (edge = edge->getNextEdgeOfFace(); edge->getTargetVertex() != apex; edge = edge->getNextEdgeOfFace())
            mesh.triangles.push_back({apex, edge->getSourceVertex(), edge->getTargetVertex()});
    }
    return mesh;
}

void check(TriangleMesh& mesh, const btCollisionShape& shape)
{
    MeshCheckOptions options;
    options.name = std::string("the surface of a ") + shape.getName() + " shape";
    check_mesh(mesh, options);
}

TriangleMesh convex_hull(const btPolyhedralConvexShape& shape)
{
    std::vector<Vec3d> points;
    for (int k = 0; k < shape.getNumVertices(); ++k) {
        btVector3 vertex;
        shape.getVertex(k, vertex);
        points.push_back(from_bullet(vertex));
    }
    require(points.size() >= 4, "a convex hull must have 4 points or more to have a volume", points.size());
    TriangleMesh mesh = hull_of(points);
    check(mesh, shape);
    return mesh;
}

/// Takes the triangles that Bullet hands over one by one.
class TriangleCollector final : public btTriangleCallback, public btInternalTriangleIndexCallback {
  public:
    TriangleMesh mesh;

    void processTriangle(btVector3* corners, int, int) override { add(corners); }
    void internalProcessTriangleIndex(btVector3* corners, int, int) override { add(corners); }

  private:
    void add(const btVector3* corners)
    {
        const int first = static_cast<int>(mesh.vertices.size());
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(from_bullet(corners[k]));
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
};

btVector3 everywhere() // as large as btGImpact's and quantized trees take
{
    return btVector3(1, 1, 1) * btScalar(1e18);
}

TriangleMesh triangle_mesh(const btConcaveShape& shape)
{
    TriangleCollector collector;
    shape.processAllTriangles(&collector, -everywhere(), everywhere());
    check(collector.mesh, shape);
    return std::move(collector.mesh);
}

/// A btConvexTriangleMeshShape is the hull of its triangles, convex or not as they may be.
TriangleMesh convex_triangle_mesh(const btConvexTriangleMeshShape& shape)
{
    TriangleCollector collector;
    shape.getMeshInterface()->InternalProcessAllTriangles(&collector, -everywhere(), everywhere());
    require(collector.mesh.vertices.size() >= 4, "a convex triangle mesh must have 4 vertices or more to have a volume",
            collector.mesh.vertices.size());
    TriangleMesh mesh = hull_of(collector.mesh.vertices);
    check(mesh, shape);
    return mesh;
}

TriangleMesh compound(const btCompoundShape& shape, double max_edge)
{
    require(shape.getNumChildShapes() > 0, "a compound shape must have children to have a volume");
    TriangleMesh mesh;
    for (int k = 0; k < shape.getNumChildShapes(); ++k)
        mesh = joined(std::move(mesh),
                      transformed(mesh_of(*shape.getChildShape(k), max_edge), from_bullet(shape.getChildTransform(k))));
    return mesh;
}

TriangleMesh uniformly_scaled(const btUniformScalingShape& shape, double max_edge)
{
    const double factor = static_cast<double>(shape.getUniformScalingFactor());
    require(factor > 0.0, "the factor of a scaled shape must be > 0", factor);
    TriangleMesh mesh = mesh_of(*shape.getChildShape(), max_edge / factor);
    for (Vec3d& vertex : mesh.vertices) vertex *= factor;
    return mesh;
}

} // namespace

} // namespace flotsam

// Qualified: the name lives in the inline namespace of Bullet's number type.
flotsam::TriangleMesh flotsam::mesh_of(const btCollisionShape& shape, double max_edge)
{
    require(max_edge > 0.0 && std::isfinite(max_edge), "max_edge must be > 0 m and finite", max_edge);
    switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
        return box(static_cast<const btBoxShape&>(shape), max_edge);
    case SPHERE_SHAPE_PROXYTYPE:
        return sphere(static_cast<const btSphereShape&>(shape), max_edge);
    case CYLINDER_SHAPE_PROXYTYPE:
        return cylinder(static_cast<const btCylinderShape&>(shape), max_edge);
    case CAPSULE_SHAPE_PROXYTYPE:
        return capsule(static_cast<const btCapsuleShape&>(shape), max_edge);
    case CONE_SHAPE_PROXYTYPE:
        return cone(static_cast<const btConeShape&>(shape), max_edge);
    case TETRAHEDRAL_SHAPE_PROXYTYPE:
    case CONVEX_POINT_CLOUD_SHAPE_PROXYTYPE:
    case CONVEX_HULL_SHAPE_PROXYTYPE:
        return convex_hull(static_cast<const btPolyhedralConvexShape&>(shape));
    case CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE:
        return convex_triangle_mesh(static_cast<const btConvexTriangleMeshShape&>(shape));
    case TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case GIMPACT_SHAPE_PROXYTYPE:
        return triangle_mesh(static_cast<const btConcaveShape&>(shape));
    case COMPOUND_SHAPE_PROXYTYPE:
        return compound(static_cast<const btCompoundShape&>(shape), max_edge);
    case UNIFORM_SCALING_SHAPE_PROXYTYPE:
        return uniformly_scaled(static_cast<const btUniformScalingShape&>(shape), max_edge);
    default:
        break;
    }
    throw std::invalid_argument(
        std::string("a ") + shape.getName() +
        " shape has no closed surface for water; a box, sphere, cylinder, capsule, cone, convex "
        "hull, triangle mesh, or a compound or scaled shape of these has one");
}
