#include "geometry/sheet.hpp"

#include "core/smooth_step.hpp"
#include "geometry/triangle_math.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace flotsam {
namespace {

constexpr double kOpposite = -0.5; ///< cosine of the normals of what may be two faces of a sheet
constexpr double kRim = 0.5;       ///< spacings beyond a rim over which the sheet comes out of sight
constexpr double kOnEdge = 1e-6;   ///< of an edge's length

} // namespace

bool on_one_side(const SheetView& a, const SheetView& b, double slack)
{
    const Vec3d way = b.place - a.place;
    const bool faces = a.normal.dot(way) > slack && b.normal.dot(way) < -slack;
    return faces || (a.side == b.side && a.normal.dot(b.normal) >= kOpposite);
}

SheetSide::SheetSide(const TriangleMesh& mesh) : query_(mesh), topology_(topology(mesh))
{
    vertex_normal_.assign(mesh.vertices.size(), Vec3d::Zero());
    vertex_at_rim_ = topology_.on_boundary;
    std::map<std::array<int, 2>, Vec3d> edges;
    const auto welded = [&](std::size_t t, std::size_t k) {
        return topology_.first_at_place[static_cast<std::size_t>(mesh.triangles[t][k])];
    };
    const auto edge = [&](std::size_t t, std::size_t k) {
        const int a = welded(t, k), b = welded(t, (k + 1) % 3);
        return std::array<int, 2>{std::min(a, b), std::max(a, b)};
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d across = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
        normal_.push_back(across.norm() > 0.0 ? Vec3d(across.normalized()) : Vec3d(Vec3d::Zero()));
        for (int k = 0; k < 3; ++k) {
            const Vec3d u = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
            const Vec3d v = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
            const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
            const auto corner = static_cast<std::size_t>(k);
            vertex_normal_[static_cast<std::size_t>(welded(t, corner))] += angle * normal_.back();
            edges.try_emplace(edge(t, corner), Vec3d::Zero()).first->second += normal_.back();
        }
    }
    edge_normal_.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) edge_normal_[t][k] = edges[edge(t, k)];
}

SheetSide::Feature SheetSide::feature_at(const Vec3d& place, std::size_t t) const
{
    const TriangleMesh& mesh = query_.mesh();
    for (int k = 0; k < 3; ++k) {
        const Vec3d a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
        if ((place - a).norm() > kOnEdge * (b - a).norm()) continue;
        const auto vertex = static_cast<std::size_t>(
            topology_.first_at_place[static_cast<std::size_t>(mesh.triangles[t][static_cast<std::size_t>(k)])]);
        return {vertex_normal_[vertex], vertex_at_rim_[vertex]};
    }
    for (int k = 0; k < 3; ++k) {
        const Vec3d a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
        if ((closest_on_segment(place, a, b) - place).norm() > kOnEdge * (b - a).norm()) continue;
        const auto edge = static_cast<std::size_t>(k);
        return {edge_normal_[t][edge], topology_.boundary[t][edge]};
    }
    return {normal_[t], false};
}

SheetSide::Foot SheetSide::foot_of(const Vec3d& point) const
{
    const SurfaceQuery::Closest closest = query_.closest(point);
    const Feature feature = feature_at(closest.point, static_cast<std::size_t>(closest.triangle));
    const Vec3d way = point - closest.point, normal = feature.normal.normalized();
    const double along = way.dot(normal);
    return {closest.point, along < 0.0 ? -closest.distance : closest.distance,
            feature.is_rim ? (way - along * normal).norm() : 0.0};
}

Sheet::Sheet(const SheetSides& sides, double spacing) : thickness_(sides.thickness), spacing_(spacing)
{
    for (const TriangleMesh& side : sides.sides) {
        sides_.emplace_back(side);
        const Aabb box = bounds(side);
        bounds_.extend(box.min);
        bounds_.extend(box.max);
    }
}

SheetView Sheet::view_from(const Vec3d& point, double reach) const
{
    SheetView view;
    if (!bounds_.inflated(reach).contains(point)) return view;
    // Of the faces about there, the one that the point is in front of; of a point that came a little too deep, the one
    // that it is the least behind.
    const double about = 1.5 * thickness_ + 1e-9 * reach;
    SheetSide::Foot foot;
    int best = -1;
    for (int side = 0; side < static_cast<int>(sides_.size()); ++side) {
        const SheetSide::Foot other = sides_[static_cast<std::size_t>(side)].foot_of(point);
        const double distance = std::abs(other.height), so_far = std::abs(foot.height);
        if (!(distance < reach)) continue;
        const bool is_nearer = best < 0 || distance + about < so_far;
        if (!is_nearer && !(distance < so_far + about && other.height > foot.height)) continue;
        best = side;
        foot = other;
    }
    if (best < 0 || foot.height == 0.0) return view;
    view.place = foot.place;
    view.normal = (point - foot.place) / foot.height;
    view.side = best;
    view.beyond_rim = smooth_step(foot.beyond_rim / (kRim * spacing_));
    return view;
}

} // namespace flotsam
