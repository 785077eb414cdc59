#include "geometry/outline_samples.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/plane_cut.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/sample_rods.hpp"

#include <algorithm>
#include <span>

namespace flotsam {
namespace {

constexpr double kStations = 48.0;     ///< a spacing
constexpr double kCornerCosine = 0.87; ///< of the turn, about 30 degrees, from which a vertex counts as a corner
constexpr double kShort = 0.5;         ///< spacings: corners nearer than that are one

/// One of many points along the offset outline.
struct Station {
    OffsetPoint point;
    bool corner = false; ///< a sample is to lie here
};
using Run = std::vector<Station>; ///< connected

Vec3d in_space(const Vec2d& p)
{
    return {p.x(), 0.0, p.y()};
}

/// The outline pulled along y: its distances in the plane are those of the outline.
TriangleMesh ribbon(const std::vector<CutLine>& lines, double half)
{
    TriangleMesh mesh;
    const Vec3d across(0.0, half, 0.0);
    for (const CutLine& line : lines) {
        const int first = static_cast<int>(mesh.vertices.size()), count = static_cast<int>(line.points.size());
        for (const Vec2d& p : line.points) {
            mesh.vertices.push_back(in_space(p) - across);
            mesh.vertices.push_back(in_space(p) + across);
        }
        for (int k = 0; k < count - (line.closed ? 0 : 1); ++k) {
            const int p = first + 2 * k, q = first + 2 * ((k + 1) % count);
            mesh.triangles.push_back({p, q + 1, q});
            mesh.triangles.push_back({p, p + 1, q + 1});
        }
    }
    return mesh;
}

/// Walks a line of the outline and collects the stations of its offset.
class OutlineWalk {
  public:
    OutlineWalk(const OffsetSurface& offset, double side, double spacing)
        : offset_(offset), side_(side), spacing_(spacing), step_(spacing / kStations)
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
        connect(line.closed);
    }

    std::vector<Run> runs;
    std::vector<bool> run_closed;
    std::vector<BarePoint> bare;

  private:
    void straight(const Vec3d& p, const Vec3d& q, const Vec3d& inward)
    {
        const int steps = std::max(1, static_cast<int>(std::ceil((q - p).norm() / step_)));
        for (int k = 0; k <= steps; ++k) {
            const Vec3d base = p + static_cast<double>(k) / steps * (q - p);
            if (const auto point = offset_.below(base, inward)) {
                add(*point, false);
            } else {
                bare.push_back({base, inward});
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
            pending_corner_ = true;
            return;
        }
        const Vec3d position = inset > 0.0 ? Vec3d(p + inset / (1.0 + cosine) * (from + to)) : p;
        if (offset_.surface().closest(position).distance >= (1.0 - OffsetSurface::kTolerance) * inset) {
            add({position, (from + to).normalized(), inset, false}, corner);
        } else {
            pending_corner_ = corner;
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
            if (offset_.surface().closest(position).distance >= (1.0 - OffsetSurface::kTolerance) * inset)
                add({position, direction, inset, false}, corner && 2 * k == steps);
        }
    }

    void add(const OffsetPoint& point, bool corner)
    {
        stations_.push_back({point, corner || pending_corner_});
        pending_corner_ = false;
    }

    /// Stations next to each other become runs. Where a layer in the middle of a thin part begins is a corner.
    void connect(bool closed)
    {
        const auto joins = [&](const Station& s, const Station& r) {
            return (s.point.position - r.point.position).norm() < 3.0 * step_;
        };
        std::vector<Run> found;
        for (Station& station : stations_) {
            if (found.empty() || !joins(found.back().back(), station)) {
                found.emplace_back();
            } else {
                Station& last = found.back().back();
                if ((last.point.position - station.point.position).norm() < 1e-9 * spacing_) {
                    last.corner = last.corner || station.corner;
                    continue;
                }
                if (last.point.thin != station.point.thin) station.corner = true;
            }
            found.back().push_back(station);
        }
        stations_.clear();
        pending_corner_ = false;
        bool loop = false;
        if (closed && !found.empty() && joins(found.back().back(), found.front().front())) {
            loop = found.size() == 1 && found.front().size() > 2;
            if (!loop && found.size() > 1) {
                Run joined = std::move(found.back());
                found.pop_back();
                joined.insert(joined.end(), found.front().begin(), found.front().end());
                found.front() = std::move(joined);
            }
        }
        for (Run& run : found) {
            runs.push_back(std::move(run));
            run_closed.push_back(loop);
        }
    }

    const OffsetSurface& offset_;
    double side_, spacing_, step_;
    std::vector<Station> stations_;
    bool pending_corner_ = false;
};

/// Points along the piece of a run at steps of equal chord, its ends included.
class EqualChords {
  public:
    explicit EqualChords(std::span<const Station> piece) : piece_(piece)
    {
        for (std::size_t k = 1; k < piece.size(); ++k) length_ += (position(k) - position(k - 1)).norm();
    }
    [[nodiscard]] double length() const { return length_; }

    /// The ends and `steps` - 1 points between them.
    [[nodiscard]] std::vector<OffsetPoint> points(int steps) const
    {
        double low = 0.0, high = 1.01 * length_ / steps;
        for (int k = 0; k < 60; ++k) {
            const double chord = 0.5 * (low + high);
            (walk(chord, steps).size() == static_cast<std::size_t>(steps) + 1 ? low : high) = chord;
        }
        std::vector<OffsetPoint> points = walk(low, steps);
        if (points.size() <= static_cast<std::size_t>(steps))
            points.resize(static_cast<std::size_t>(steps) + 1, points.back());
        points.back() = piece_.back().point;
        return points;
    }

  private:
    [[nodiscard]] const Vec3d& position(std::size_t k) const { return piece_[k].point.position; }

    /// At most steps + 1 points, fewer if the piece ends before.
    [[nodiscard]] std::vector<OffsetPoint> walk(double chord, int steps) const
    {
        std::vector<OffsetPoint> points{piece_.front().point};
        for (std::size_t k = 1; k < piece_.size() && points.size() <= static_cast<std::size_t>(steps); ++k) {
            double from = 0.0; // part of this segment that is behind
            while (points.size() <= static_cast<std::size_t>(steps)) {
                const Vec3d a = position(k - 1) - points.back().position, way = position(k) - position(k - 1);
                if ((a + way).norm() < chord) break;
                const double at = way.dot(a), way_sq = way.squaredNorm();
                const double root = std::sqrt(std::max(0.0, at * at - way_sq * (a.squaredNorm() - chord * chord)));
                from = std::clamp((root - at) / way_sq, from, 1.0);
                OffsetPoint point = piece_[from < 0.5 ? k - 1 : k].point;
                point.position = position(k - 1) + from * way;
                points.push_back(point);
            }
        }
        return points;
    }

    std::span<const Station> piece_;
    double length_ = 0.0;
};

void sample_run(Run run, bool closed, double spacing, std::vector<OffsetPoint>& samples)
{
    if (closed) {
        const auto corner = std::find_if(run.begin(), run.end(), [](const Station& s) { return s.corner; });
        if (corner != run.end()) std::rotate(run.begin(), corner, run.end());
        run.push_back(run.front());
    }
    std::vector<std::size_t> ends{0};
    double since = 0.0;
    for (std::size_t k = 1; k < run.size(); ++k) {
        since += (run[k].point.position - run[k - 1].point.position).norm();
        if (!run[k].corner || since < kShort * spacing) continue;
        ends.push_back(k);
        since = 0.0;
    }
    if (ends.back() + 1 < run.size()) {
        if (since < kShort * spacing && ends.size() > 1) ends.pop_back();
        ends.push_back(run.size() - 1);
    }
    if (ends.size() == 1) samples.push_back(run.front().point);
    const std::span<const Station> all = run;
    for (std::size_t k = 1; k < ends.size(); ++k) {
        const EqualChords piece(all.subspan(ends[k - 1], ends[k] - ends[k - 1] + 1));
        auto points = piece.points(std::max(1, static_cast<int>(std::lround(piece.length() / spacing))));
        if (closed || k + 1 < ends.size()) points.pop_back(); // the next piece begins with it
        samples.insert(samples.end(), points.begin(), points.end());
    }
}

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

} // namespace

std::vector<OffsetPoint> sample_outline(const SurfaceQuery& surface, const SurfaceSampleSettings& settings)
{
    const std::vector<CutLine> lines = cut_at_y0(surface.mesh());
    if (lines.empty()) throw InputError("a mesh of a two-dimensional world must cross the plane y = 0");
    const SurfaceQuery outline(ribbon(lines, surface.bounds().size().maxCoeff()));
    const OffsetSurface offset(outline, settings);
    OutlineWalk walk(offset, settings.solid == SurfaceSampleSettings::Solid::inside ? -1.0 : 1.0, settings.spacing);
    for (const CutLine& line : lines) walk.along(line);

    std::vector<OffsetPoint> samples;
    for (std::size_t k = 0; k < walk.runs.size(); ++k)
        sample_run(walk.runs[k], walk.run_closed[k], settings.spacing, samples);
    drop_second_layers(samples, settings.spacing);
    if (offset.inset() > 0.0) sample_rods(samples, walk.bare, offset, settings.spacing);
    for (OffsetPoint& sample : samples) sample.position.y() = 0.0;
    return samples;
}

} // namespace flotsam
