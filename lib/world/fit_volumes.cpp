#include "world/fit_volumes.hpp"

#include "geometry/plane_cut.hpp"
#include "geometry/point_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace flotsam {
namespace {

constexpr int kRounds = 5;
constexpr double kInFront = 0.5;    ///< of the surface, where water lies [spacings]
constexpr double kStep = 0.7;       ///< from one such point to the next [spacings]
constexpr double kPatch = 0.35;     ///< longest edge of a patch of the surface [spacings]
constexpr double kLeastSeen = 1e-3; ///< of full density: less has no say
constexpr double kMostChange = 3.0;

/// A piece of the surface, and its outward normal times its area (in 2-D: a line, times its length).
struct Patch {
    Vec3d middle, area;
};

/// Cut along its shortest edge into strips, and these again, until no edge is longer than `size`: slivers fall into few
/// parts.
void add_patches(const std::array<Vec3d, 3>& triangle, double size, std::vector<Patch>& patches)
{
    const auto length = [&](std::size_t k) { return (triangle[(k + 1) % 3] - triangle[k]).norm(); };
    const std::array<double, 3> edges{length(0), length(1), length(2)};
    const auto shortest = static_cast<std::size_t>(std::min_element(edges.begin(), edges.end()) - edges.begin());
    const double longest = *std::max_element(edges.begin(), edges.end());
    const Vec3d &a = triangle[shortest], &b = triangle[(shortest + 1) % 3], &tip = triangle[(shortest + 2) % 3];
    if (!(longest > size)) {
        patches.push_back({(a + b + tip) / 3.0, 0.5 * (b - a).cross(tip - a)});
        return;
    }
    const int strips = static_cast<int>(std::ceil(1.5 * longest / size));
    for (int k = 0; k < strips; ++k) {
        const double low = static_cast<double>(k) / strips, high = (k + 1.0) / strips;
        const Vec3d p = a + low * (tip - a), q = b + low * (tip - b), r = b + high * (tip - b),
                    s = a + high * (tip - a);
        add_patches({p, q, r}, size, patches);
        if (k + 1 < strips) add_patches({p, r, s}, size, patches);
    }
}

void add_patches(const CutLine& line, double size, std::vector<Patch>& patches)
{
    const std::size_t count = line.points.size(), segments = count - (line.closed ? 0 : 1);
    for (std::size_t k = 0; k < segments; ++k) {
        const Vec2d &a = line.points[k], way = line.points[(k + 1) % count] - a;
        const int n = std::max(1, static_cast<int>(std::ceil(way.norm() / size)));
        for (int i = 0; i < n; ++i)
            patches.push_back({in_space(a + (i + 0.5) / n * way), in_space(Vec2d(way.y(), -way.x()) / n)});
    }
}

std::vector<Patch> patches_of(const TriangleMesh& mesh, const VolumeFit& fit)
{
    std::vector<Patch> patches;
    const double size = kPatch * fit.particle_spacing;
    if (fit.dimensions == 2) {
        for (const CutLine& line : cut_at_y0(mesh)) add_patches(line, size, patches);
        return patches;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        add_patches({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, size, patches);
    return patches;
}

using LatticePoint = std::array<std::int32_t, 3>;

/// Points of a lattice that may lie in front of the surface under which the samples are, each once.
std::vector<LatticePoint> lattice_near(std::span<const Vec3d> samples, double step, double reach, int dimensions)
{
    std::vector<LatticePoint> near;
    for (const Vec3d& sample : samples) {
        std::array<std::int32_t, 3> low{}, high{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = sample[static_cast<Eigen::Index>(axis)];
            if (axis == 1 && dimensions == 2) continue;
            low[axis] = static_cast<std::int32_t>(std::ceil((at - reach) / step));
            high[axis] = static_cast<std::int32_t>(std::floor((at + reach) / step));
        }
        for (std::int32_t x = low[0]; x <= high[0]; ++x)
            for (std::int32_t y = low[1]; y <= high[1]; ++y)
                for (std::int32_t z = low[2]; z <= high[2]; ++z)
                    if ((step * Vec3d(x, y, z) - sample).squaredNorm() <= reach * reach) near.push_back({x, y, z});
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
}

/// Half a spacing in front of the solid's surface, one per 0.7 spacings squared: the points of a lattice that lie about
/// there, moved along the way to the surface. Around edges they lie on an arc.
std::vector<Vec3d> points_in_front(const SurfaceQuery& solid, const VolumeFit& fit, std::span<const Vec3d> samples,
                                   const Workers& workers)
{
    const double d = fit.particle_spacing, step = kStep * d, away = kInFront * d;
    const double reach = away + 0.5 * step + 0.8 * d; // to the nearest sample, two thirds of a spacing deep
    std::optional<SurfaceQuery> in_plane;
    if (fit.dimensions == 2) in_plane.emplace(ribbon(cut_at_y0(solid.mesh()), 10.0 * d));
    const SurfaceQuery& surface = in_plane ? *in_plane : solid;
    const std::vector<LatticePoint> lattice = lattice_near(samples, step, reach, fit.dimensions);
    std::vector<Vec3d> points(lattice.size());
    std::vector<std::uint8_t> is_in_front(lattice.size(), 0);
    workers.for_each(lattice.size(), [&](std::size_t k) {
        const Vec3d at = step * Vec3d(lattice[k][0], lattice[k][1], lattice[k][2]);
        const SurfaceQuery::Closest closest = surface.closest(at);
        if (std::abs(closest.distance - away) > 0.5 * step || solid.inside(at)) return;
        points[k] = closest.point + away / closest.distance * (at - closest.point);
        is_in_front[k] = surface.closest(points[k]).distance > 0.9 * away; // else something else is there
    });
    std::size_t count = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (is_in_front[k] != 0) points[count++] = points[k];
    points.resize(count);
    return points;
}

/// The field F(r) / r: along the way from a point, with the kernel at the point as its divergence.
class KernelField {
  public:
    KernelField(const Kernel& kernel, int dimensions)
        : support_(static_cast<double>(kernel.support())), dimensions_(dimensions)
    {
        integral_.push_back(0.0);
        for (int k = 0; k < kSteps; ++k) {
            const double r = (k + 0.5) * support_ / kSteps;
            const double shell = dimensions == 3 ? r * r : r;
            integral_.push_back(integral_.back() +
                                shell * static_cast<double>(kernel.value(static_cast<Scalar>(r))) * support_ / kSteps);
        }
    }
    [[nodiscard]] double support() const { return support_; }
    /// For 0 < r <= support.
    [[nodiscard]] double operator()(double r) const
    {
        const double at = std::min(r / support_ * kSteps, kSteps - 1e-9);
        const auto k = static_cast<std::size_t>(at);
        const double within = integral_[k] + (at - static_cast<double>(k)) * (integral_[k + 1] - integral_[k]);
        return (within - integral_.back()) / (dimensions_ == 3 ? r * r * r : r * r);
    }

  private:
    static constexpr int kSteps = 2000;
    double support_;
    int dimensions_;
    std::vector<double> integral_;
};

/// What each of the points is to see of the solid.
std::vector<double> seen_of_solid(const TriangleMesh& mesh, const VolumeFit& fit, const Kernel& kernel,
                                  std::span<const Vec3d> points, const Workers& workers)
{
    const KernelField field(kernel, fit.dimensions);
    const std::vector<Patch> patches = patches_of(mesh, fit);
    std::vector<Vec3d> middles;
    for (const Patch& patch : patches) middles.push_back(patch.middle);
    const PointGrid grid(middles, field.support());
    std::vector<double> seen(points.size(), 0.0);
    workers.for_each(points.size(), [&](std::size_t k) {
        grid.for_near(points[k], field.support(), [&](std::size_t p, double distance_sq) {
            if (distance_sq > 0.0)
                seen[k] += field(std::sqrt(distance_sq)) * (middles[p] - points[k]).dot(patches[p].area);
        });
        seen[k] *= fit.density;
    });
    return seen;
}

/// One round: `points` see `want`.
class Round {
  public:
    Round(const Kernel& kernel, std::span<const Vec3d> samples, std::span<const Vec3d> points,
          std::span<const double> want, const Workers& workers)
        : kernel_(kernel), support_(static_cast<double>(kernel.support())), samples_(samples), points_(points),
          want_(want), workers_(workers), sample_grid_(samples, support_), point_grid_(points, support_),
          ratio_(points.size())
    {
    }
    void improve(std::span<double> volumes)
    {
        workers_.for_each(points_.size(), [&](std::size_t k) {
            double have = 0.0;
            sample_grid_.for_near(points_[k], support_,
                                  [&](std::size_t b, double distance_sq) { have += volumes[b] * weight(distance_sq); });
            ratio_[k] = have > 0.0 && want_[k] > kLeastSeen ? want_[k] / have : 1.0;
        });
        workers_.for_each(samples_.size(), [&](std::size_t b) {
            double sum = 0.0, of = 0.0;
            point_grid_.for_near(samples_[b], support_, [&](std::size_t k, double distance_sq) {
                const double w = weight(distance_sq);
                sum += w * ratio_[k];
                of += w;
            });
            if (of > 0.0) volumes[b] *= sum / of;
        });
    }

  private:
    [[nodiscard]] double weight(double distance_sq) const
    {
        return static_cast<double>(kernel_.value(static_cast<Scalar>(std::sqrt(distance_sq))));
    }

    const Kernel& kernel_;
    double support_;
    std::span<const Vec3d> samples_, points_;
    std::span<const double> want_;
    const Workers& workers_;
    PointGrid sample_grid_, point_grid_;
    std::vector<double> ratio_;
};

} // namespace

void fit_volumes(const SurfaceQuery& solid, const VolumeFit& fit, std::span<const Vec3d> positions,
                 std::span<double> volumes, const Workers& workers)
{
    const std::vector<Vec3d> points = points_in_front(solid, fit, positions, workers);
    const Kernel kernel(fit.kernel, fit.particle_spacing, fit.dimensions);
    const std::vector<double> want = seen_of_solid(solid.mesh(), fit, kernel, points, workers);
    const std::vector<double> before(volumes.begin(), volumes.end());
    Round round(kernel, positions, points, want, workers);
    for (int k = 0; k < kRounds; ++k) round.improve(volumes);
    for (std::size_t b = 0; b < volumes.size(); ++b)
        volumes[b] = std::clamp(volumes[b], before[b] / kMostChange, before[b] * kMostChange);
}

} // namespace flotsam
