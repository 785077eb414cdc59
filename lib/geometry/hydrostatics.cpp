#include "flotsam/geometry/hydrostatics.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "geometry/mesh_connectivity.hpp"
#include "geometry/mesh_crossing.hpp"
#include "geometry/plane_cut.hpp"
#include "geometry/submerged_moments.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

std::size_t index(int triangle)
{
    return static_cast<std::size_t>(triangle);
}

} // namespace

Submerged submerged_part(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    const SubmergedMoments sum = submerged_moments(closed, pose, water_level);
    Submerged part;
    part.waterplane_area = std::max(sum.area, 0.0);
    if (!(sum.volume > 0.0)) return part;
    part.volume = sum.volume;
    part.center_of_buoyancy = Vec3d(pose.position.x(), pose.position.y(), water_level) + sum.moment / sum.volume;
    return part;
}

Waterplane waterplane(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    return waterplane_of(submerged_moments(closed, pose, water_level), pose);
}

double lowest_point(const TriangleMesh& mesh, const Pose& pose)
{
    return height_range(mesh, pose).low;
}

TriangleMesh outer_surface(const TriangleMesh& closed)
{
    constexpr double kTouching = 1e-6; // of the bounds' diagonal
    const std::vector<std::vector<int>> parts = connected_parts(closed, triangle_adjacency(closed)).triangles;
    TriangleMesh outward = closed; // every part
    std::vector<int> cavities;     // triangles
    std::vector<const std::vector<int>*> solids;
    for (const std::vector<int>& part : parts) {
        const bool faces_outward = mass_properties(with_triangles(closed, part)).volume >= 0.0;
        if (faces_outward) {
            solids.push_back(&part);
            continue;
        }
        cavities.insert(cavities.end(), part.begin(), part.end());
        for (const int t : part) std::swap(outward.triangles[index(t)][1], outward.triangles[index(t)][2]);
    }
    if (cavities.empty()) return closed;
    std::vector<int> outer;
    for (const std::vector<int>* solid : solids) {
        const PartSide side = side_of_part(outward, *solid, cavities, kTouching * bounds(closed).size().norm());
        if (side.inside <= side.outside) outer.insert(outer.end(), solid->begin(), solid->end());
    }
    return with_triangles(closed, outer);
}

// The water line spans no area with an origin in it. Outside lies to the right of the way along, so what a
// line goes around on the water's side counts positive.
Submerged submerged_section(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    const Vec2d origin(pose.position.x(), water_level);
    double area = 0.0, waterline = 0.0;
    Vec2d moment = Vec2d::Zero();
    for (const CutLine& line : cut_at_y0(transformed(closed, pose))) {
        for (std::size_t k = 0; k < line.points.size(); ++k) {
            Vec2d a = line.points[k] - origin;
            Vec2d b = line.points[(k + 1) % line.points.size()] - origin;
            if (a.y() >= 0.0 && b.y() >= 0.0) continue;
            const Vec2d crossing(a.x() + (b.x() - a.x()) * (a.y() / (a.y() - b.y())), 0.0); // used if there is one
            if (a.y() > 0.0) a = crossing;
            if (b.y() > 0.0) b = crossing;
            const double piece = 0.5 * (a.x() * b.y() - a.y() * b.x());
            area += piece;
            moment += piece * (a + b) / 3.0;
            waterline += b.x() - a.x();
        }
    }
    Submerged part;
    part.waterplane_area = std::max(waterline, 0.0);
    if (!(area > 0.0)) return part;
    const Vec2d center = origin + moment / area;
    part.volume = area;
    part.center_of_buoyancy = Vec3d(center.x(), 0.0, center.y());
    return part;
}

std::optional<double> equilibrium_draft(const TriangleMesh& closed, const Quatd& orientation, double displaced_volume)
{
    require(displaced_volume >= 0.0 && std::isfinite(displaced_volume), "displaced_volume must be >= 0 m^3 and finite",
            displaced_volume);
    const Pose turned{Vec3d::Zero(), orientation};
    const HeightRange range = height_range(closed, turned);
    const double height = range.high - range.low;
    const double whole = submerged_part(closed, turned, range.low + 2.0 * height).volume;
    if (displaced_volume > whole * (1.0 + 1e-12)) return std::nullopt;
    if (displaced_volume >= whole) return height;
    if (displaced_volume == 0.0) return 0.0;
    const double guess = range.low + height * displaced_volume / whole;
    return level_of_volume(closed, turned, displaced_volume, range, guess) - range.low;
}

} // namespace flotsam
