#include "flotsam/geometry/hydrostatics.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/plane_cut.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {

namespace {

/// What is left of a triangle below z = 0: up to four corners, in the triangle's order.
struct Wetted {
    std::array<Vec3d, 4> corners;
    std::size_t count = 0;
    void add(const Vec3d& corner) { corners[count++] = corner; }
};

/// Where an edge meets z = 0; always reckoned from its lower end, so that both its triangles find the same point.
Vec3d crossing(const Vec3d& a, const Vec3d& b)
{
    const Vec3d& low = a.z() < b.z() ? a : b;
    const Vec3d& high = a.z() < b.z() ? b : a;
    Vec3d point = low + (high - low) * (low.z() / (low.z() - high.z()));
    point.z() = 0.0;
    return point;
}

Wetted clip(const std::array<Vec3d, 3>& triangle)
{
    Wetted wetted;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& a = triangle[k];
        const Vec3d& b = triangle[(k + 1) % 3];
        if (a.z() <= 0.0) wetted.add(a);
        if ((a.z() < 0.0 && b.z() > 0.0) || (a.z() > 0.0 && b.z() < 0.0)) wetted.add(crossing(a, b));
    }
    return wetted;
}

struct HeightRange {
    double low;
    double high;
};

HeightRange height_range(const TriangleMesh& mesh, const Pose& pose)
{
    require(!mesh.vertices.empty(), "the height of a mesh without vertices is not defined");
    const Vec3d up_body = pose.orientation.toRotationMatrix().row(2);
    HeightRange range{up_body.dot(mesh.vertices.front()), up_body.dot(mesh.vertices.front())};
    for (const Vec3d& vertex : mesh.vertices) {
        const double height = up_body.dot(vertex);
        range.low = std::min(range.low, height);
        range.high = std::max(range.high, height);
    }
    return {pose.position.z() + range.low, pose.position.z() + range.high};
}

} // namespace

// The origin is put into the water plane: the waterplane, which closes the wetted surface, then spans no volume with
// it, and the wetted triangles alone give volume and first moment. Their vector areas sum to minus the waterplane's.
Submerged submerged_part(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    const Mat3d rotation = pose.orientation.toRotationMatrix();
    const Vec3d origin(pose.position.x(), pose.position.y(), water_level);
    const Vec3d shift = pose.position - origin;
    double volume = 0.0;
    double area = 0.0;
    Vec3d moment = Vec3d::Zero();
    for (std::size_t t = 0; t < closed.triangles.size(); ++t) {
        std::array<Vec3d, 3> triangle;
        for (int k = 0; k < 3; ++k) triangle[static_cast<std::size_t>(k)] = shift + rotation * closed.corner(t, k);
        // A face that lies in the plane is no part of what is below it.
        if (!(triangle[0].z() < 0.0 || triangle[1].z() < 0.0 || triangle[2].z() < 0.0)) continue;
        const Wetted wetted = clip(triangle);
        for (std::size_t k = 2; k < wetted.count; ++k) {
            const Vec3d& a = wetted.corners[0];
            const Vec3d& b = wetted.corners[k - 1];
            const Vec3d& c = wetted.corners[k];
            const double piece = a.dot(b.cross(c)) / 6.0;
            volume += piece;
            moment += 0.25 * piece * (a + b + c);
            area -= 0.5 * (b - a).cross(c - a).z();
        }
    }
    Submerged part;
    part.waterplane_area = std::max(area, 0.0);
    if (!(volume > 0.0)) return part;
    part.volume = volume;
    part.center_of_buoyancy = origin + moment / volume;
    return part;
}

double lowest_point(const TriangleMesh& mesh, const Pose& pose)
{
    return height_range(mesh, pose).low;
}

// As above: the water line spans no area with an origin in it. Outside lies to the right of the way along, so what a
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

// Newton with the waterplane area as the derivative, kept inside a shrinking bracket: the volume never falls with the
// draft, but its derivative may be zero or jump.
std::optional<double> equilibrium_draft(const TriangleMesh& closed, const Quatd& orientation, double displaced_volume)
{
    require(displaced_volume >= 0.0 && std::isfinite(displaced_volume), "displaced_volume must be >= 0 m^3 and finite",
            displaced_volume);
    const Pose turned{Vec3d::Zero(), orientation};
    const auto [keel, top] = height_range(closed, turned);
    const double height = top - keel;
    const double whole = submerged_part(closed, turned, keel + 2.0 * height).volume;
    if (displaced_volume > whole * (1.0 + 1e-12)) return std::nullopt;
    if (displaced_volume >= whole) return height;
    if (displaced_volume == 0.0) return 0.0;

    double low = 0.0;
    double high = height;
    double draft = height * displaced_volume / whole;
    for (int iteration = 0; iteration < 200 && high - low > 1e-15 * height; ++iteration) {
        const Submerged part = submerged_part(closed, turned, keel + draft);
        const double excess = part.volume - displaced_volume;
        (excess > 0.0 ? high : low) = draft;
        const double newton = draft - excess / part.waterplane_area;
        const bool is_safe = newton > low && newton < high; // false for NaN too
        const double next = is_safe ? newton : 0.5 * (low + high);
        const bool is_settled = std::abs(excess) <= 1e-13 * displaced_volume && is_safe;
        if (std::abs(next - draft) <= 1e-14 * height || is_settled) return next;
        draft = next;
    }
    return draft;
}

} // namespace flotsam
