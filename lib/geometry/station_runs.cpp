#include "geometry/station_runs.hpp"

#include <algorithm>
#include <span>

namespace flotsam {
namespace {

constexpr double kShort = 0.5; ///< spacings: corners nearer than that are one

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

} // namespace

void RunBuilder::add(const OffsetPoint& point, bool corner)
{
    stations_.push_back({point, corner || pending_corner_});
    pending_corner_ = false;
}

void RunBuilder::finish(bool closed)
{
    std::vector<Run> found;
    for (Station& station : stations_) {
        if (found.empty() || !joins(found.back().stations.back(), station)) {
            found.emplace_back();
        } else {
            Station& last = found.back().stations.back();
            if ((last.point.position - station.point.position).norm() < 1e-7 * step_) {
                last.corner = last.corner || station.corner;
                continue;
            }
            // where a layer in the middle of a thin part begins is a corner
            if (last.point.thin != station.point.thin) station.corner = true;
        }
        found.back().stations.push_back(station);
    }
    stations_.clear();
    pending_corner_ = false;
    if (closed && !found.empty() && joins(found.back().stations.back(), found.front().stations.front())) {
        if (found.size() == 1) {
            found.front().closed = found.front().stations.size() > 2;
        } else {
            std::vector<Station> joined = std::move(found.back().stations);
            found.pop_back();
            joined.insert(joined.end(), found.front().stations.begin(), found.front().stations.end());
            found.front().stations = std::move(joined);
        }
    }
    runs.insert(runs.end(), found.begin(), found.end());
}

void sample_run(Run given, double spacing, std::vector<OffsetPoint>& samples)
{
    std::vector<Station>& run = given.stations;
    const bool closed = given.closed;
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

} // namespace flotsam
