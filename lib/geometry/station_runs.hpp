#pragma once

#include "geometry/offset_surface.hpp"

#include <vector>

namespace flotsam {

constexpr double kStationsPerSpacing = 48.0;
constexpr double kCornerCosine = 0.87; ///< of the turn, about 30 degrees, from which a line has a corner

/// One of many points along a line of the offset surface.
struct Station {
    OffsetPoint point;
    bool corner = false; ///< a sample is to lie here
};

/// Stations that follow on each other without a gap.
struct Run {
    std::vector<Station> stations; ///< a closed run does not repeat its first
    bool closed = false;
};

/// Takes the stations of one line in order and splits them into runs where the surface has a gap.
class RunBuilder {
  public:
    explicit RunBuilder(double step) : step_(step) {}

    void add(const OffsetPoint& point, bool corner);
    /// A corner that lies off the surface: the next station stands for it.
    void corner_missed() { pending_corner_ = true; }
    /// Ends the line; `closed`: its last station is followed by its first.
    void finish(bool closed);

    std::vector<Run> runs;

  private:
    [[nodiscard]] bool joins(const Station& s, const Station& r) const
    {
        return (s.point.position - r.point.position).norm() < 3.0 * step_;
    }

    double step_;
    std::vector<Station> stations_;
    bool pending_corner_ = false;
};

/// Samples at the ends and corners of a run and, at steps of equal chord close to `spacing`, between them.
void sample_run(Run run, double spacing, std::vector<OffsetPoint>& samples);

} // namespace flotsam
