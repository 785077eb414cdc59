#include "flotsam/geometry/shapes.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace flotsam {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFinest = 5000.0;  ///< sizes in edges; more would ask for hundreds of millions of triangles
constexpr int kFewestSegments = 24; ///< around a round shape, however long the edges may be

void require_size(double size, std::string_view what)
{
    require(size > 0.0 && std::isfinite(size), std::string(what) + " must be > 0 m and finite", size);
}

void require_size(double size, double max_edge, std::string_view what)
{
    require_size(size, what);
    require(size <= kFinest * max_edge, "max_edge must be at least 1/5000 of the " + std::string(what), max_edge);
}

/// Sides of a box by name, corners counter-clockwise from outside; corner bits: 1 = +x, 2 = +y, 4 = +z.
struct Side {
    std::string_view name;
    std::array<int, 4> corners;
};
constexpr std::array<Side, 6> kSides{{{"-x", {0, 4, 6, 2}},
                                      {"+x", {1, 3, 7, 5}},
                                      {"-y", {0, 1, 5, 4}},
                                      {"+y", {2, 6, 7, 3}},
                                      {"-z", {0, 2, 3, 1}},
                                      {"+z", {4, 5, 7, 6}}}};

/// Adds a side, taking over only the corners that a side in use has.
class BoxBuilder {
  public:
    explicit BoxBuilder(const Aabb& box) : box_(box) { index_.fill(-1); }

    void add(const Side& side)
    {
        const auto [a, b, c, d] = side.corners;
        mesh.triangles.push_back({vertex(a), vertex(b), vertex(c)});
        mesh.triangles.push_back({vertex(a), vertex(c), vertex(d)});
    }

    TriangleMesh mesh;

  private:
    int vertex(int corner)
    {
        int& index = index_[static_cast<std::size_t>(corner)];
        if (index >= 0) return index;
        index = static_cast<int>(mesh.vertices.size());
        mesh.vertices.emplace_back((corner & 1 ? box_.max : box_.min).x(), (corner & 2 ? box_.max : box_.min).y(),
                                   (corner & 4 ? box_.max : box_.min).z());
        return index;
    }

    Aabb box_;
    std::array<int, 8> index_{};
};

TriangleMesh box_mesh(const Vec3d& edges)
{
    for (int axis = 0; axis < 3; ++axis) require_size(edges[axis], "box edge");
    BoxBuilder builder({-0.5 * edges, 0.5 * edges});
    for (const Side& side : kSides) builder.add(side);
    return builder.mesh;
}

TriangleMesh icosahedron()
{
    const double g = std::numbers::phi;
    TriangleMesh mesh;
    mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    return mesh;
}

std::array<double, 2> edge_range(const TriangleMesh& mesh)
{
    std::array<double, 2> range{1e300, 0.0};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const double length = (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm();
            range = {std::min(range[0], length), std::max(range[1], length)};
        }
    return range;
}

TriangleMesh sphere_mesh(double radius, double max_edge)
{
    require_size(radius, max_edge, "sphere radius");
    TriangleMesh mesh = icosahedron();
    const auto project = [&] {
        for (Vec3d& vertex : mesh.vertices) vertex *= radius / vertex.norm();
    };
    project();
    while (mesh.triangles.size() < 320 || edge_range(mesh)[1] > max_edge) {
        const double below_shortest = 0.99 * edge_range(mesh)[0];
        mesh = refined(std::move(mesh), below_shortest); // every edge is split, once
        project();
    }
    const double exact = 4.0 / 3.0 * kPi * radius * radius * radius;
    const double scale = std::cbrt(exact / mass_properties(mesh).volume);
    for (Vec3d& vertex : mesh.vertices) vertex *= scale;
    return mesh;
}

/// Vertices of one ring, `first` to `first + count - 1`, counter-clockwise about +z.
struct Ring {
    int first;
    int count;
    [[nodiscard]] int at(int k) const { return first + k % count; }
};

Ring add_ring(TriangleMesh& mesh, double radius, double z, int count)
{
    const Ring ring{static_cast<int>(mesh.vertices.size()), count};
    for (int k = 0; k < count; ++k) {
        const double angle = 2.0 * kPi * k / count;
        mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return ring;
}

/// Triangles between two rings, each step on the ring that lags; facing outward where `upper` lies above `lower`, and
/// up where it lies inside it.
void stitch(TriangleMesh& mesh, const Ring& lower, const Ring& upper)
{
    for (int i = 0, j = 0; i < lower.count || j < upper.count;) {
        const double lower_after = (i + 0.5) / lower.count;
        const double upper_after = (j + 0.5) / upper.count;
        if (j == upper.count || (i < lower.count && lower_after <= upper_after)) {
            mesh.triangles.push_back({lower.at(i), lower.at(i + 1), upper.at(j)});
            ++i;
        } else {
            mesh.triangles.push_back({lower.at(i), upper.at(j + 1), upper.at(j)});
            ++j;
        }
    }
}

/// Closes a ring at height z by rings of falling size; `is_top` faces +z.
void add_cap(TriangleMesh& mesh, Ring outer, double radius, double z, int rings, bool is_top)
{
    const auto first = mesh.triangles.size();
    const int segments = outer.count;
    for (int k = rings - 1; k > 0; --k) {
        const Ring inner = add_ring(mesh, radius * k / rings, z, std::max(6, segments * k / rings));
        stitch(mesh, outer, inner);
        outer = inner;
    }
    const auto center = static_cast<int>(mesh.vertices.size());
    mesh.vertices.emplace_back(0.0, 0.0, z);
    for (int k = 0; k < outer.count; ++k) mesh.triangles.push_back({outer.at(k), outer.at(k + 1), center});
    if (is_top) return;
    for (auto t = first; t < mesh.triangles.size(); ++t) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
}

/// Prism with a polygon of exactly the circle's area, along z.
TriangleMesh prism_mesh(double radius, double height, double max_edge, int rows, int cap_rings)
{
    const int segments = std::max(kFewestSegments, static_cast<int>(std::ceil(2.0 * kPi * radius / max_edge)));
    const double angle = 2.0 * kPi / segments;
    const double polygon_radius = radius * std::sqrt(angle / std::sin(angle));
    TriangleMesh mesh;
    const Ring bottom = add_ring(mesh, polygon_radius, -0.5 * height, segments);
    Ring top = bottom;
    for (int row = 1; row <= rows; ++row) {
        const Ring next = add_ring(mesh, polygon_radius, height * (static_cast<double>(row) / rows - 0.5), segments);
        stitch(mesh, top, next);
        top = next;
    }
    add_cap(mesh, top, polygon_radius, 0.5 * height, cap_rings, true);
    add_cap(mesh, bottom, polygon_radius, -0.5 * height, cap_rings, false);
    return mesh;
}

TriangleMesh cylinder_mesh(const CylinderShape& shape, double max_edge)
{
    require_size(shape.radius, max_edge, "cylinder radius");
    require_size(shape.height, max_edge, "cylinder height");
    const auto pieces = [&](double length) { return std::max(1, static_cast<int>(std::ceil(length / max_edge))); };
    return prism_mesh(shape.radius, shape.height, max_edge, pieces(shape.height), pieces(shape.radius));
}

TriangleMesh disc_mesh(double radius, double max_edge)
{
    require_size(radius, max_edge, "disc radius");
    TriangleMesh mesh = prism_mesh(radius, 1.0, max_edge, 1, 1);
    for (Vec3d& vertex : mesh.vertices) vertex = Vec3d(vertex.y(), vertex.z(), vertex.x());
    return mesh;
}

/// One tessellation per alternative of Shape.
struct Tessellate {
    double max_edge;
    TriangleMesh operator()(const BoxShape& shape) const { return box_mesh(shape.edges); }
    TriangleMesh operator()(const SphereShape& shape) const { return sphere_mesh(shape.radius, max_edge); }
    TriangleMesh operator()(const CylinderShape& shape) const { return cylinder_mesh(shape, max_edge); }
    TriangleMesh operator()(const DiscShape& shape) const { return disc_mesh(shape.radius, max_edge); }
    TriangleMesh operator()(const MeshShape& shape) const { return shape.mesh; }
};

} // namespace

TriangleMesh tessellate(const Shape& shape, double max_edge)
{
    require_size(max_edge, "max_edge");
    return std::visit(Tessellate{max_edge}, shape);
}

TriangleMesh container_box(const Aabb& box, const std::vector<std::string>& open)
{
    for (int axis = 0; axis < 3; ++axis) require_size(box.max[axis] - box.min[axis], "container edge");
    for (const std::string& name : open)
        require(std::any_of(kSides.begin(), kSides.end(), [&](const Side& side) { return side.name == name; }),
                "open sides of a container must be \"-x\", \"+x\", \"-y\", \"+y\", \"-z\" or \"+z\"", '"' + name + '"');
    BoxBuilder builder(box);
    for (const Side& side : kSides)
        if (std::find(open.begin(), open.end(), side.name) == open.end()) builder.add(side);
    require(!builder.mesh.empty(), "at least one side of a container must be closed");
    return builder.mesh;
}

} // namespace flotsam
