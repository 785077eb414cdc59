#include "geometry/layer_samples.hpp"

#include "geometry/blue_noise.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/sample_candidates.hpp"
#include "geometry/sample_rods.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

constexpr double kManyCandidates = 20.0, kFewCandidates = 6.0; ///< per sample, of small and of large surfaces
constexpr double kAllCandidates = 40000.0;                     ///< between them, altogether
constexpr double kHexagonal =
    1.0746; ///< distance of neighbours in a hexagonal lattice of unit area each, sqrt(2/sqrt 3)
// The push has the reach of the kernel and some of the last step's drift: that evens out the density of samples as
// fluid feels it to 1.5 % (4 % without drift, 6 % with a reach of 1.5 spacings).
constexpr double kReach = 2.0;  ///< spacings up to which samples push each other
constexpr double kPush = 0.4;   ///< spacings a lone pair at zero distance moves apart in one step
constexpr double kDrift = 0.85; ///< of the last step that goes on
constexpr int kSteps = 50;
constexpr double kClosest = 0.75; ///< spacings: the closer one of a pair goes
constexpr double kHole = 0.85;    ///< spacings from the next sample: a candidate becomes one

/// Area of the surface that candidates stand for. The two layers of a solid little thicker than two insets, and the
/// one layer of a thinner one that candidates reach from both sides, count as one.
double covered_area(const SampleCandidates& candidates, double spacing, const Workers& workers)
{
    const double reach = 0.6 * spacing;
    const PointGrid grid(positions_of(candidates.points), reach);
    std::vector<double> scratch;
    return workers.ordered_sum<double>(candidates.points.size(), scratch, [&](std::size_t i) {
        const OffsetPoint& point = candidates.points[i];
        int same = 0, opposite = 0;
        grid.for_near(point.position, reach, [&](std::size_t j, double) {
            ++(candidates.points[j].direction.dot(point.direction) > -0.5 ? same : opposite);
        });
        return candidates.area_each * same / (same + opposite);
    });
}

double mesh_area(const TriangleMesh& mesh)
{
    double area = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        area += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
    return area;
}

double rim_length(const OffsetSurface& offset, const Aabb& region)
{
    double length = 0.0;
    const TriangleMesh& mesh = offset.surface().mesh();
    for (const MeshEdge& edge : offset.topology().edges) {
        if (edge.triangles != 1) continue;
        Vec3d a = mesh.vertices[static_cast<std::size_t>(edge.a)], b = mesh.vertices[static_cast<std::size_t>(edge.b)];
        if (clip_segment(region, a, b)) length += (b - a).norm();
    }
    return length;
}

/// One step in which samples within `moves` push their neighbours along the surface.
void repel(std::vector<OffsetPoint>& samples, std::vector<Vec3d>& drift, std::size_t fixed, const Aabb& moves,
           const OffsetSurface& offset, double spacing, const Workers& workers)
{
    drift.resize(samples.size(), Vec3d::Zero());
    const double reach = kReach * spacing;
    const std::vector<Vec3d> before = positions_of(samples);
    const PointGrid grid(before, reach);
    workers.for_each(samples.size() - fixed, [&](std::size_t k) {
        const std::size_t i = fixed + k;
        if (!moves.contains(before[i])) return;
        Vec3d push = Vec3d::Zero();
        grid.for_near(before[i], reach, [&](std::size_t j, double distance_sq) {
            if (j == i || distance_sq == 0.0) return;
            const double distance = std::sqrt(distance_sq), gap = 1.0 - distance / reach;
            push += gap * gap / distance * (before[i] - before[j]);
        });
        push = kPush * spacing * push + kDrift * drift[i];
        const double length = push.norm(), longest = 0.15 * spacing;
        if (length > longest) push *= longest / length;
        if (const auto moved = offset.project(before[i] + push, samples[i])) samples[i] = *moved;
        drift[i] = samples[i].position - before[i];
    });
}

void drop_crowded(std::vector<OffsetPoint>& samples, double closest)
{
    const PointGrid grid(positions_of(samples), closest);
    std::vector<bool> dropped(samples.size(), false);
    std::vector<OffsetPoint> kept;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        grid.for_near(samples[i].position, closest,
                      [&](std::size_t j, double) { dropped[i] = dropped[i] || (j < i && !dropped[j]); });
        if (!dropped[i]) kept.push_back(samples[i]);
    }
    samples = std::move(kept);
}

/// Candidates farther than `hole` from every sample become samples. Were there any?
bool fill_holes(std::vector<OffsetPoint>& samples, const SampleCandidates& candidates, double hole)
{
    const PointGrid grid(positions_of(samples), hole);
    const auto before = static_cast<std::ptrdiff_t>(samples.size());
    for (const OffsetPoint& point : candidates.points) {
        const auto near = [&](const OffsetPoint& added) { return (added.position - point.position).norm() < hole; };
        if (grid.nearest(point.position, hole) < hole) continue;
        if (std::none_of(samples.begin() + before, samples.end(), near)) samples.push_back(point);
    }
    return static_cast<std::ptrdiff_t>(samples.size()) > before;
}

/// `samples` come as those that stay where they are; the rest is chosen from the candidates and evened out.
void choose_samples(std::vector<OffsetPoint>& samples, const SampleCandidates& candidates, std::size_t count,
                    const Aabb& moves, const OffsetSurface& offset, double spacing, const Workers& workers)
{
    const std::size_t fixed = samples.size();
    {
        std::vector<Vec3d> positions = positions_of(samples);
        positions.reserve(fixed + candidates.points.size());
        for (const OffsetPoint& candidate : candidates.points) positions.push_back(candidate.position);
        for (std::size_t i : eliminate_crowded(positions, fixed, count, kHexagonal * spacing, workers))
            if (i >= fixed) samples.push_back(candidates.points[i - fixed]); // the fixed ones always stay
    }
    std::vector<Vec3d> drift;
    for (int step = 0; step < kSteps; ++step) repel(samples, drift, fixed, moves, offset, spacing, workers);
    for (int round = 0; round < 3; ++round) {
        drop_crowded(samples, kClosest * spacing);
        if (!fill_holes(samples, candidates, kHole * spacing)) return;
        drift.clear();
        for (int step = 0; step < 5; ++step) repel(samples, drift, fixed, moves, offset, spacing, workers);
    }
    drop_crowded(samples, kClosest * spacing);
}

/// sample_rods that leaves the order of the samples there are.
void add_rods(std::vector<OffsetPoint>& samples, const SampleCandidates& candidates, const OffsetSurface& offset,
              double spacing)
{
    std::vector<OffsetPoint> with_rods = samples;
    sample_rods(with_rods, candidates.bare, offset, spacing);
    samples.insert(samples.end(), with_rods.begin() + static_cast<std::ptrdiff_t>(samples.size()), with_rods.end());
}

} // namespace

std::vector<OffsetPoint> sample_layer(const OffsetSurface& offset, const SurfaceSampleSettings& settings,
                                      std::vector<OffsetPoint> fixed, const LayerPart& part, const Workers& workers)
{
    const double d = settings.spacing;
    const double rough_count = mesh_area(offset.surface().mesh()) / (d * d);
    const double each = std::clamp(kAllCandidates / rough_count, kFewCandidates, kManyCandidates);
    const SampleCandidates candidates = sample_candidates(offset, each / (d * d), settings.seed, part.region);
    std::vector<OffsetPoint> samples = std::move(fixed);
    if (!candidates.points.empty()) {
        // Samples on a rim, or where the surface is cut, have half of their surroundings off the surface.
        double rim = rim_length(offset, part.region);
        for (std::size_t side = 0; side < 6; ++side)
            if (!part.is_continued[side]) rim += candidates.cut[side];
        const double area = covered_area(candidates, d, workers) + 0.5 * d * rim;
        const auto count = static_cast<std::size_t>(std::max(1.0, std::round(area / (d * d))));
        choose_samples(samples, candidates, count, part.moves, offset, d, workers);
    }
    add_rods(samples, candidates, offset, d);
    return samples;
}

} // namespace flotsam
