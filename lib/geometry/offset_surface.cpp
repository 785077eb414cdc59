#include "geometry/offset_surface.hpp"

#include "geometry/split_mix.hpp"
#include "geometry/triangle_math.hpp"

namespace flotsam {
namespace {

constexpr double kTight = 1e-6; ///< of the depth: candidates that lie shallower overlap the next facet's
constexpr double kLoose = 1e-3; ///< of the inset, by which a moved point may lie too shallow
constexpr int kShrinkSteps = 24;
constexpr double kShallowest = 0.05; ///< of the inset: the last bit of a wedge's tip goes without samples
constexpr double kOpposite = -0.5;   ///< cosine below which the two nearest walls make a part thin, not a wedge

Vec3d unit_normal(const TriangleMesh& mesh, std::size_t t)
{
    const Vec3d cross = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
    const double length = cross.norm();
    return length > 0.0 ? Vec3d(cross / length) : Vec3d(Vec3d::Zero());
}

} // namespace

OffsetSurface::OffsetSurface(const SurfaceQuery& surface, const SurfaceSampleSettings& settings)
    : surface_(surface), topology_(flotsam::topology(surface.mesh())), inset_(settings.inset),
      side_(settings.solid == SurfaceSampleSettings::Solid::inside ? -1.0 : 1.0),
      inside_(settings.solid == SurfaceSampleSettings::Solid::inside)
{
    if (settings.solid == SurfaceSampleSettings::Solid::both) inset_ = 0.0;
    for (std::size_t t = 0; t < surface.mesh().triangles.size(); ++t) {
        normals_.push_back(unit_normal(surface.mesh(), t));
        for (bool boundary : topology_.boundary[t]) has_rim_ = has_rim_ || boundary;
    }
}

std::optional<OffsetPoint> OffsetSurface::below(const Vec3d& base, const Vec3d& direction) const
{
    OffsetPoint point{base + inset_ * direction, direction, inset_, false};
    if (inset_ == 0.0) return point;
    // Shrinking ball (Ma, Bae & Choi 2012): the ball that touches the surface at `base` and holds no other point of it.
    Vec3d other = base;
    for (int step = 0; step < kShrinkSteps; ++step) {
        const auto nearest = surface_.closest(point.position);
        if (nearest.distance >= (1.0 - kTight) * point.depth) {
            if (!point.thin) return point;
            const Vec3d to_other = (other - point.position).normalized();
            if (to_other.dot(-direction) < kOpposite) return point;
            return std::nullopt;
        }
        const Vec3d chord = nearest.point - base;
        const double along = direction.dot(chord), depth = chord.squaredNorm() / (2.0 * along);
        if (!(along > 0.0 && depth > kShallowest * inset_)) return std::nullopt;
        other = nearest.point;
        point.depth = std::min(point.depth, depth);
        point.position = base + point.depth * direction;
        point.thin = true;
    }
    return std::nullopt;
}

bool OffsetSurface::holds(const Vec3d& position) const
{
    const auto nearest = surface_.closest(position);
    const double slack = kTight * inset_ + 1e-12 * position.cwiseAbs().maxCoeff();
    if (std::abs(nearest.distance - inset_) > slack) return false;
    if (inset_ == 0.0) return true;
    if (has_rim_) return (position - nearest.point).dot(inward(static_cast<std::size_t>(nearest.triangle))) > 0.0;
    return surface_.inside(position) == inside_;
}

bool OffsetSurface::at_rim(const SurfaceQuery::Closest& nearest) const
{
    if (!has_rim_) return false;
    const auto t = static_cast<std::size_t>(nearest.triangle);
    const TriangleMesh& mesh = surface_.mesh();
    for (int k = 0; k < 3; ++k) {
        if (!topology_.boundary[t][static_cast<std::size_t>(k)]) continue;
        const Vec3d a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
        if ((closest_on_segment(nearest.point, a, b) - nearest.point).norm() < 1e-9 * (b - a).norm()) return true;
    }
    return false;
}

Vec3d OffsetSurface::direction_at(const Vec3d& position, const SurfaceQuery::Closest& nearest) const
{
    Vec3d inward_here = inward(static_cast<std::size_t>(nearest.triangle));
    if (nearest.distance < 1e-6 * inset_ || at_rim(nearest)) return inward_here;
    return (position - nearest.point) / nearest.distance;
}

std::optional<OffsetPoint> OffsetSurface::project(const Vec3d& position, const OffsetPoint& from) const
{
    auto nearest = surface_.closest(position);
    if (inset_ == 0.0)
        return OffsetPoint{nearest.point, inward(static_cast<std::size_t>(nearest.triangle)), 0.0, false};
    // Of a thin part one can fall out, and find the right distance again outside.
    const auto reachable = [&](const Vec3d& there) { return !surface_.sweep(from.position, there); };
    const Vec3d first_base = nearest.point, first_direction = direction_at(position, nearest);
    if (!from.thin) {
        Vec3d direction = first_direction;
        for (int step = 0; step < 6; ++step) {
            if (direction.dot(from.direction) <= -0.5) return std::nullopt;
            const Vec3d moved = nearest.point + inset_ * direction;
            nearest = surface_.closest(moved);
            if (std::abs(nearest.distance - inset_) <= kLoose * inset_) {
                if (!reachable(moved)) return std::nullopt;
                return OffsetPoint{moved, direction, inset_, false};
            }
            direction = direction_at(moved, nearest);
        }
    }
    const auto point = below(first_base, first_direction);
    return point && reachable(point->position) ? point : std::nullopt;
}

OffsetPoint OffsetSurface::deepest_below(const Vec3d& base, const Vec3d& direction) const
{
    SplitMix random(1);
    double step = 0.25 * inset_;
    Vec3d position = base + 1e-3 * inset_ * direction;
    double depth = surface_.closest(position).distance;
    while (step > 1e-4 * inset_ && depth < inset_) {
        bool better = false;
        for (int trial = 0; trial < 16 && !better; ++trial) {
            // half the depth at most: so it never leaves the solid
            const Vec3d next = position + std::min(step, 0.5 * depth) * random.direction_about_z(-1.0);
            const double next_depth = surface_.closest(next).distance;
            better = next_depth > depth;
            if (better) {
                position = next;
                depth = next_depth;
            }
        }
        step *= better ? 1.2 : 0.6;
    }
    const auto nearest = surface_.closest(position);
    return {position, direction_at(position, nearest), std::min(depth, inset_), depth < (1.0 - kLoose) * inset_};
}

} // namespace flotsam
