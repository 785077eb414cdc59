#include "mesh_crossing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flotsam {

namespace {

struct Corners {
    std::array<Vec3d, 3> points;
    Vec3d normal; ///< unit; zero for a sliver, which then crosses nothing
};

Corners corners_of(const TriangleMesh& mesh, int triangle)
{
    const auto t = static_cast<std::size_t>(triangle);
    Corners corners{{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, Vec3d::Zero()};
    const Vec3d normal = (corners.points[1] - corners.points[0]).cross(corners.points[2] - corners.points[0]);
    const double length = normal.norm();
    if (length > 0.0) corners.normal = normal / length;
    return corners;
}

/// Signed distances of a triangle's corners to another one's plane, zero where below the tolerance.
std::array<double, 3> distances(const Corners& triangle, const Corners& plane, double tolerance)
{
    std::array<double, 3> distance{};
    for (std::size_t k = 0; k < 3; ++k) {
        distance[k] = plane.normal.dot(triangle.points[k] - plane.points[0]);
        if (std::abs(distance[k]) <= tolerance) distance[k] = 0.0;
    }
    return distance;
}

bool straddles(const std::array<double, 3>& d)
{
    return *std::min_element(d.begin(), d.end()) < 0.0 && *std::max_element(d.begin(), d.end()) > 0.0;
}

bool is_flat(const std::array<double, 3>& d)
{
    return d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0;
}

/// The two points where a straddling triangle meets the plane, ordered along `axis`.
std::array<Vec3d, 2> cut(const Corners& triangle, const std::array<double, 3>& d, const Vec3d& axis)
{
    std::array<Vec3d, 2> ends;
    std::size_t found = 0;
    for (std::size_t k = 0; k < 3 && found < 2; ++k) {
        const std::size_t next = (k + 1) % 3;
        if (d[k] == 0.0)
            ends[found++] = triangle.points[k];
        else if (d[k] * d[next] < 0.0)
            ends[found++] =
                triangle.points[k] + (triangle.points[next] - triangle.points[k]) * (d[k] / (d[k] - d[next]));
    }
    if (axis.dot(ends[0]) > axis.dot(ends[1])) std::swap(ends[0], ends[1]);
    return ends;
}

/// **Source:** Moeller 1997, "A fast triangle-triangle intersection test"; here with a least length of the cut.
std::optional<Vec3d> transversal_place(const Corners& a, const Corners& b, const std::array<double, 3>& distance_a,
                                       const std::array<double, 3>& distance_b, double tolerance)
{
    const Vec3d direction = a.normal.cross(b.normal);
    const double sine = direction.norm();
    if (!(sine > 0.0)) return std::nullopt;
    const Vec3d axis = direction / sine;
    const auto ends_a = cut(a, distance_a, axis);
    const auto ends_b = cut(b, distance_b, axis);
    const Vec3d& from = axis.dot(ends_a[0]) > axis.dot(ends_b[0]) ? ends_a[0] : ends_b[0];
    const Vec3d& to = axis.dot(ends_a[1]) < axis.dot(ends_b[1]) ? ends_a[1] : ends_b[1];
    if (!(axis.dot(to - from) > tolerance)) return std::nullopt;
    return 0.5 * (from + to);
}

/// Two triangles in one plane overlap unless a line along one of their edges parts them.
bool overlaps_in_plane(const Corners& a, const Corners& b, double tolerance)
{
    for (const Corners* triangle : {&a, &b})
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d edge = triangle->points[(k + 1) % 3] - triangle->points[k];
            const Vec3d axis = triangle->normal.cross(edge).normalized();
            std::array<double, 2> low{1e300, 1e300};
            std::array<double, 2> high{-1e300, -1e300};
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::array<double, 2> at{axis.dot(a.points[corner]), axis.dot(b.points[corner])};
                for (std::size_t side = 0; side < 2; ++side) {
                    low[side] = std::min(low[side], at[side]);
                    high[side] = std::max(high[side], at[side]);
                }
            }
            if (!(std::min(high[0], high[1]) - std::max(low[0], low[1]) > tolerance)) return false;
        }
    return true;
}

std::optional<Vec3d> crossing_place(const Corners& a, const Corners& b, double tolerance)
{
    const auto distance_a = distances(a, b, tolerance);
    const auto distance_b = distances(b, a, tolerance);
    if (straddles(distance_a) && straddles(distance_b))
        return transversal_place(a, b, distance_a, distance_b, tolerance);
    if (is_flat(distance_a) && is_flat(distance_b) && a.normal.dot(b.normal) > 0.5 &&
        overlaps_in_plane(a, b, tolerance))
        return (a.points[0] + a.points[1] + a.points[2]) / 3.0;
    return std::nullopt;
}

std::vector<Aabb> triangle_bounds(const TriangleMesh& mesh)
{
    std::vector<Aabb> boxes(mesh.triangles.size());
    for (std::size_t t = 0; t < boxes.size(); ++t)
        for (int k = 0; k < 3; ++k) boxes[t].extend(mesh.corner(t, k));
    return boxes;
}

bool overlaps(const Aabb& a, const Aabb& b)
{
    return (a.min.array() <= b.max.array()).all() && (b.min.array() <= a.max.array()).all();
}

/// Twice the area that edge a-b spans with `point`, seen along z, > 0 to the left of it. Both triangles of an edge find
/// the same number but for its sign, and where it is zero the side of a point moved a little to +x, and less to +y.
struct EdgeSide {
    double area;
    bool is_left;
};

EdgeSide edge_side(const TriangleMesh& mesh, int a, int b, const Vec3d& point)
{
    const Vec3d from = mesh.vertices[static_cast<std::size_t>(std::min(a, b))] - point;
    const Vec3d to = mesh.vertices[static_cast<std::size_t>(std::max(a, b))] - point;
    const double area = from.x() * to.y() - from.y() * to.x();
    bool is_left = area > 0.0;
    if (area == 0.0) is_left = from.y() != to.y() ? from.y() > to.y() : to.x() > from.x();
    return a < b ? EdgeSide{area, is_left} : EdgeSide{-area, !is_left};
}

/// +1 or -1 if the way from `point` to +z leaves or enters the solid through the triangle, 0 if it misses it.
int crossing_above(const TriangleMesh& mesh, int triangle, const Vec3d& point)
{
    const auto [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
    const EdgeSide ab = edge_side(mesh, a, b, point);
    const EdgeSide bc = edge_side(mesh, b, c, point);
    const EdgeSide ca = edge_side(mesh, c, a, point);
    if (ab.is_left != bc.is_left || bc.is_left != ca.is_left) return 0;
    const auto height = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].z() - point.z(); };
    const double weighted = bc.area * height(a) + ca.area * height(b) + ab.area * height(c);
    if (ab.is_left) return weighted > 0.0 ? 1 : 0;
    return weighted < 0.0 ? -1 : 0;
}

bool lies_on(const Corners& triangle, const Vec3d& point, double tolerance)
{
    const bool is_sliver = triangle.normal.isZero();
    if (is_sliver || std::abs(triangle.normal.dot(point - triangle.points[0])) > tolerance) return false;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d edge = triangle.points[(k + 1) % 3] - triangle.points[k];
        if (triangle.normal.cross(edge).normalized().dot(point - triangle.points[k]) < -tolerance) return false;
    }
    return true;
}

/// How often some triangles, which close a solid, wind around a point; nothing if it lies on one of them. Counted along
/// +z, since most triangles are then sorted out by their bounds: a hull of 100 000 may have a thousand parts in it.
std::optional<int> winding_number(const TriangleMesh& mesh, const std::vector<int>& triangles, const Vec3d& point,
                                  double tolerance)
{
    int winding = 0;
    for (const int t : triangles) {
        const auto& corners = mesh.triangles[static_cast<std::size_t>(t)];
        const auto is_beside = [&](int axis) {
            const double x = mesh.vertices[static_cast<std::size_t>(corners[0])][axis] - point[axis];
            const double y = mesh.vertices[static_cast<std::size_t>(corners[1])][axis] - point[axis];
            const double z = mesh.vertices[static_cast<std::size_t>(corners[2])][axis] - point[axis];
            return std::min({x, y, z}) > tolerance || std::max({x, y, z}) < -tolerance;
        };
        if (is_beside(0) || is_beside(1)) continue;
        if (lies_on(corners_of(mesh, t), point, tolerance)) return std::nullopt;
        winding += crossing_above(mesh, t, point);
    }
    return winding;
}

} // namespace

Crossings find_crossings(const TriangleMesh& mesh, double tolerance, bool inside_parts_too)
{
    // Sweep along the longest axis: each triangle meets those that have not ended where it begins.
    const std::vector<Aabb> boxes = triangle_bounds(mesh);
    int axis = 0;
    bounds(mesh).size().maxCoeff(&axis);
    std::vector<int> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    const auto box = [&](int t) -> const Aabb& { return boxes[static_cast<std::size_t>(t)]; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return box(a).min[axis] < box(b).min[axis]; });

    Crossings crossings;
    std::vector<int> active;
    for (const int t : order) {
        std::erase_if(active, [&](int other) { return box(other).max[axis] < box(t).min[axis]; });
        for (const int other : active) {
            const bool is_same_part = mesh.part_of_triangle[static_cast<std::size_t>(t)] ==
                                      mesh.part_of_triangle[static_cast<std::size_t>(other)];
            auto& found = is_same_part ? crossings.inside_a_part : crossings.between_parts;
            if (found || (is_same_part && !inside_parts_too) || !overlaps(box(t), box(other))) continue;
            if (const auto place = crossing_place(corners_of(mesh, t), corners_of(mesh, other), tolerance))
                found = Crossing{other, t, *place};
        }
        active.push_back(t);
    }
    return crossings;
}

PartSide side_of_part(const TriangleMesh& mesh, const std::vector<int>& part, const std::vector<int>& other,
                      double tolerance)
{
    constexpr std::size_t kTried = 12; // more than one only for cuts that run along edges of both parts
    PartSide side;
    const std::size_t step = std::max<std::size_t>(1, part.size() / kTried);
    for (std::size_t k = 0; k < part.size(); k += step) {
        const Corners tried = corners_of(mesh, part[k]);
        const Vec3d point = (tried.points[0] + tried.points[1] + tried.points[2]) / 3.0;
        const auto winding = winding_number(mesh, other, point, tolerance);
        if (!winding) continue;
        if (*winding > 0) side.place_inside = point;
        ++(*winding > 0 ? side.inside : side.outside);
    }
    return side;
}

} // namespace flotsam
