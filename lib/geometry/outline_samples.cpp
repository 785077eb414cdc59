#include "geometry/outline_samples.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/plane_cut.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/sample_rods.hpp"
#include "geometry/sheet_sides.hpp"
#include "geometry/station_runs.hpp"

#include <algorithm>

namespace flotsam {
namespace {

/// Walks a line of the outline and collects the stations of its offset.
class OutlineWalk {
  public:
    OutlineWalk(const OffsetSurface& offset, double side, double spacing)
        : line_(spacing / kStationsPerSpacing), offset_(offset), side_(side), step_(spacing / kStationsPerSpacing)
    {
    }

    void along(const CutLine& line)
    {
        const std::size_t count = line.points.size(), segments = count - (line.closed ? 0 : 1);
        std::vector<Vec3d> inward;
        for (std::size_t k = 0; k < segments; ++k) {
            const Vec2d way = (line.points[(k + 1) % count] - line.points[k]).normalized();
            inward.emplace_back(side_ * way.y(), 0.0, -side_ * way.x());
        }
        for (std::size_t k = 0; k < segments; ++k) {
            const Vec3d p = in_space(line.points[k]), q = in_space(line.points[(k + 1) % count]);
            if (k > 0 || line.closed) turn(p, q, inward[(k + segments - 1) % segments], inward[k]);
            straight(p, q, inward[k]);
        }
        line_.finish(line.closed);
    }

    [[nodiscard]] const std::vector<Run>& runs() const { return line_.runs; }
    [[nodiscard]] const std::vector<BarePoint>& bare() const { return bare_; }

  private:
    void straight(const Vec3d& p, const Vec3d& q, const Vec3d& inward)
    {
        const int steps = std::max(1, static_cast<int>(std::ceil((q - p).norm() / step_)));
        for (int k = 0; k <= steps; ++k) {
            const Vec3d base = p + static_cast<double>(k) / steps * (q - p);
            if (const auto point = offset_.below(base, inward)) {
                line_.add(*point, false);
            } else {
                bare_.push_back({base, inward});
            }
        }
    }

    void turn(const Vec3d& p, const Vec3d& next, const Vec3d& from, const Vec3d& to)
    {
        const double cosine = std::clamp(from.dot(to), -1.0, 1.0);
        const bool corner = cosine < kCornerCosine;
        const double inset = offset_.inset();
        if (inset > 0.0 && from.dot(next - p) < 0.0) return arc(p, from, to, corner);
        if (inset > 0.0 && cosine < -0.999) {
            return line_.corner_missed();
        }
        const Vec3d position = inset > 0.0 ? Vec3d(p + inset / (1.0 + cosine) * (from + to)) : p;
        if (offset_.holds(position)) {
            line_.add({position, (from + to).normalized(), inset, false}, corner);
        } else if (corner) {
            line_.corner_missed();
        }
    }

    void arc(const Vec3d& p, const Vec3d& from, const Vec3d& to, bool corner)
    {
        const double inset = offset_.inset(), angle = std::acos(std::clamp(from.dot(to), -1.0, 1.0));
        const Vec3d across = (to - from.dot(to) * from).normalized();
        const int steps = 2 * std::max(1, static_cast<int>(std::ceil(0.5 * angle * inset / step_)));
        for (int k = 0; k <= steps; ++k) {
            const double turned = angle * k / steps;
            const Vec3d direction = std::cos(turned) * from + std::sin(turned) * across;
            const Vec3d position = p + inset * direction;
            if (offset_.holds(position)) line_.add({position, direction, inset, false}, corner && 2 * k == steps);
        }
    }

    RunBuilder line_;
    std::vector<BarePoint> bare_;
    const OffsetSurface& offset_;
    double side_, step_;
};

/// A thin part is walked along both its sides: the second layer of samples goes.
void drop_second_layers(std::vector<OffsetPoint>& samples, double spacing)
{
    const double closest = 0.7 * spacing;
    const PointGrid grid(positions_of(samples), closest);
    std::vector<bool> dropped(samples.size(), false);
    std::vector<OffsetPoint> kept;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        grid.for_near(samples[i].position, closest, [&](std::size_t j, double distance_sq) {
            const bool rival = samples[i].thin || samples[j].thin || distance_sq < 0.0625 * spacing * spacing;
            dropped[i] = dropped[i] || (j < i && !dropped[j] && rival);
        });
        if (!dropped[i]) kept.push_back(samples[i]);
    }
    samples = std::move(kept);
}

std::vector<OffsetPoint> sample_lines(const SurfaceQuery& outline, const std::vector<CutLine>& lines,
                                      const SurfaceSampleSettings& settings)
{
    const OffsetSurface offset(outline, settings);
    OutlineWalk walk(offset, settings.solid == SurfaceSampleSettings::Solid::inside ? -1.0 : 1.0, settings.spacing);
    for (const CutLine& line : lines) walk.along(line);

    std::vector<OffsetPoint> samples;
    for (const Run& run : walk.runs()) sample_run(run, settings.spacing, samples);
    drop_second_layers(samples, settings.spacing);
    if (offset.inset() > 0.0) sample_rods(samples, walk.bare(), offset, settings.spacing);
    for (OffsetPoint& sample : samples) sample.position.y() = 0.0;
    return samples;
}

} // namespace

std::vector<std::vector<OffsetPoint>> sample_outline(const SurfaceQuery& surface, const SurfaceSampleSettings& settings)
{
    const std::vector<CutLine> lines = cut_at_y0(surface.mesh());
    if (lines.empty()) throw InputError("a mesh of a two-dimensional world must cross the plane y = 0");
    const SheetSides sheet = sheet_sides(surface, settings);
    if (sheet.sides.empty()) {
        const SurfaceQuery outline(ribbon(lines, surface.bounds().size().maxCoeff()));
        return {sample_lines(outline, lines, settings)};
    }
    std::vector<std::vector<OffsetPoint>> result;
    SurfaceSampleSettings of_side = settings;
    of_side.solid = SurfaceSampleSettings::Solid::inside;
    for (const TriangleMesh& side : sheet.sides)
        result.push_back(sample_lines(SurfaceQuery(side), cut_at_y0(side), of_side));
    return result;
}

} // namespace flotsam
