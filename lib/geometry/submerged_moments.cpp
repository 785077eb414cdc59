#include "geometry/submerged_moments.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/wetted_triangle.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

/// The waterplane closes the wetted surface, and f(x, y) e_z has no divergence: the integral of f over the waterplane
/// is minus that of f n_z over the wetted triangles, whose projections n_z dA onto the plane are integrated here.
void add_wetted(SubmergedMoments& sum, const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    const double piece = a.dot(b.cross(c)) / 6.0;
    const Vec3d corners = a + b + c;
    sum.volume += piece;
    sum.moment += 0.25 * piece * corners;

    const double projected = 0.5 * (b - a).cross(c - a).z();
    const Eigen::Vector2d p = a.head<2>(), q = b.head<2>(), r = c.head<2>(), total = corners.head<2>();
    sum.area -= projected;
    sum.shadow += std::abs(projected);
    sum.area_moment -= projected / 3.0 * total;
    sum.area_second_moment -=
        projected / 12.0 * (p * p.transpose() + q * q.transpose() + r * r.transpose() + total * total.transpose());
}

} // namespace

// The origin is put into the water plane: the waterplane then spans no volume with it, and the wetted triangles alone
// give volume and first moment.
SubmergedMoments submerged_moments(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    const Mat3d rotation = pose.orientation.toRotationMatrix();
    const Vec3d shift(0.0, 0.0, pose.position.z() - water_level);
    SubmergedMoments sum;
    for (std::size_t t = 0; t < closed.triangles.size(); ++t) {
        std::array<Vec3d, 3> triangle;
        for (int k = 0; k < 3; ++k) triangle[static_cast<std::size_t>(k)] = shift + rotation * closed.corner(t, k);
        // A face that lies in the plane is no part of what is below it.
        if (!(triangle[0].z() < 0.0 || triangle[1].z() < 0.0 || triangle[2].z() < 0.0)) continue;
        const WettedTriangle wetted = wetted_part(triangle);
        for (std::size_t k = 2; k < wetted.count; ++k)
            add_wetted(sum, wetted.corners[0], wetted.corners[k - 1], wetted.corners[k]);
    }
    return sum;
}

Waterplane waterplane_of(const SubmergedMoments& sum, const Pose& pose)
{
    constexpr double kRounding = 1e-12;
    Waterplane plane;
    if (!(sum.area > kRounding * sum.shadow)) return plane;
    const Eigen::Vector2d center = sum.area_moment / sum.area;
    plane.area = sum.area;
    plane.centroid = pose.position.head<2>() + center;
    plane.second_moment = sum.area_second_moment - sum.area * center * center.transpose();
    return plane;
}

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

// Newton with the waterplane area as the derivative, kept inside a shrinking bracket: the volume never falls with the
// level, but its derivative may be zero or jump.
double level_of_volume(const TriangleMesh& closed, const Pose& pose, double displaced_volume, const HeightRange& range,
                       double guess)
{
    const double height = range.high - range.low;
    double low = range.low;
    double high = range.high;
    double level = guess > low && guess < high ? guess : 0.5 * (low + high);
    for (int iteration = 0; iteration < 200 && high - low > 1e-15 * height; ++iteration) {
        const SubmergedMoments sum = submerged_moments(closed, pose, level);
        const double excess = sum.volume - displaced_volume;
        (excess > 0.0 ? high : low) = level;
        const double newton = level - excess / std::max(sum.area, 0.0);
        const bool is_safe = newton > low && newton < high; // false for NaN too
        const double next = is_safe ? newton : 0.5 * (low + high);
        const bool is_settled = std::abs(excess) <= 1e-13 * displaced_volume && is_safe;
        if (std::abs(next - level) <= 1e-14 * height || is_settled) return next;
        level = next;
    }
    return level;
}

} // namespace flotsam
