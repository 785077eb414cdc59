#include "geometry/crease_samples.hpp"

#include "geometry/point_grid.hpp"
#include "geometry/sample_rods.hpp"
#include "geometry/station_runs.hpp"

#include <Eigen/SVD>

#include <algorithm>

namespace flotsam {
namespace {

/// An edge of the mesh whose offset is a line that samples are to follow.
struct Feature {
    int a, b;                    ///< vertices
    std::vector<Vec3d> inward;   ///< of its one or two triangles
    Vec3d shift = Vec3d::Zero(); ///< from the edge to its offset
    bool used = false;
};

class CreaseWalk {
  public:
    CreaseWalk(const OffsetSurface& offset, double spacing)
        : offset_(offset), mesh_(offset.surface().mesh()), step_(spacing / kStationsPerSpacing), line_(step_),
          features_at_(mesh_.vertices.size())
    {
        for (const MeshEdge& edge : offset.topology().edges) find_feature(edge);
    }

    const std::vector<Run>& runs()
    {
        for (int v = 0; v < static_cast<int>(features_at_.size()); ++v) // lines between junctions, then loops
            if (at(v).size() != 2)
                for (int feature : at(v)) walk(v, feature);
        for (int feature = 0; feature < static_cast<int>(features_.size()); ++feature) walk(of(feature).a, feature);
        return line_.runs;
    }

  private:
    void find_feature(const MeshEdge& edge)
    {
        Feature feature{edge.a, edge.b, {offset_.inward(static_cast<std::size_t>(edge.left))}};
        if (edge.triangles == 2) {
            feature.inward.push_back(offset_.inward(static_cast<std::size_t>(edge.right)));
            const double cosine = feature.inward[0].dot(feature.inward[1]);
            const bool reflex = feature.inward[0].dot(point(edge.apex) - point(edge.a)) < 0.0;
            if (cosine > kCornerCosine || cosine < -0.9 || (reflex && offset_.inset() > 0.0)) return;
        } else if (edge.triangles > 2) {
            return;
        }
        const Vec3d sum = feature.inward.front() + feature.inward.back();
        feature.shift = offset_.inset() / sum.dot(feature.inward.front()) * sum;
        for (int v : {edge.a, edge.b})
            features_at_[static_cast<std::size_t>(v)].push_back(static_cast<int>(features_.size()));
        features_.push_back(std::move(feature));
    }

    void walk(int start, int feature)
    {
        if (of(feature).used) return;
        int v = start;
        end(v);
        for (;;) {
            of(feature).used = true;
            const int next = of(feature).a == v ? of(feature).b : of(feature).a;
            straight(point(v) + of(feature).shift, point(next) + of(feature).shift, feature);
            v = next;
            const int onward = at(v).size() != 2 ? -1 : at(v)[at(v)[0] == feature ? 1 : 0];
            if (onward < 0) {
                end(v);
            } else {
                turn(v, feature, onward);
            }
            if (onward < 0 || of(onward).used) return line_.finish(onward >= 0 && v == start);
            feature = onward;
        }
    }

    /// The end of a line, where it may meet others: the point as deep below all their triangles.
    void end(int v)
    {
        if (at(v).size() == 2) return; // a loop begins anywhere
        add(point(v) + common_shift(at(v)), at(v).front(), true);
    }

    void turn(int v, int from, int to)
    {
        const Vec3d way_in = direction_to(v, from), way_out = -direction_to(v, to);
        const bool sharp = way_in.dot(way_out) < kCornerCosine;
        const Feature &before = of(from), &after = of(to);
        const bool rim = before.inward.size() == 1 && after.inward.size() == 1;
        if (rim && offset_.inset() > 0.0 && before.inward[0].dot(way_out) < -1e-9)
            return arc(point(v), before.inward[0], after.inward[0], sharp);
        const Vec3d there = point(v) + common_shift({from, to});
        straight(point(v) + before.shift, there, from);
        add(there, from, sharp);
        straight(there, point(v) + after.shift, to);
    }

    void straight(const Vec3d& p, const Vec3d& q, int feature)
    {
        const int steps = static_cast<int>(std::ceil((q - p).norm() / step_));
        for (int k = 0; k <= steps; ++k)
            add(steps == 0 ? p : Vec3d(p + static_cast<double>(k) / steps * (q - p)), feature, false);
    }

    void arc(const Vec3d& p, const Vec3d& from, const Vec3d& to, bool sharp)
    {
        const double inset = offset_.inset(), angle = std::acos(std::clamp(from.dot(to), -1.0, 1.0));
        const Vec3d across = (to - from.dot(to) * from).normalized();
        const int steps = 2 * std::max(1, static_cast<int>(std::ceil(0.5 * angle * inset / step_)));
        for (int k = 0; k <= steps; ++k) {
            const double turned = angle * k / steps;
            const Vec3d direction = std::cos(turned) * from + std::sin(turned) * across;
            add_exact({p + inset * direction, direction, inset, false}, sharp && 2 * k == steps);
        }
    }

    void add(const Vec3d& position, int feature, bool is_corner)
    {
        const Vec3d direction = (of(feature).inward.front() + of(feature).inward.back()).normalized();
        add_exact({position, direction, offset_.inset(), false}, is_corner);
    }
    void add_exact(const OffsetPoint& point, bool is_corner)
    {
        if (offset_.holds(point.position)) {
            line_.add(point, is_corner);
        } else if (is_corner) {
            line_.corner_missed();
        }
    }

    /// Shortest x with inward . x = inset for all triangles at the features.
    [[nodiscard]] Vec3d common_shift(const std::vector<int>& features) const
    {
        if (offset_.inset() == 0.0) return Vec3d::Zero();
        std::vector<Vec3d> planes;
        for (int feature : features)
            planes.insert(planes.end(), features_[static_cast<std::size_t>(feature)].inward.begin(),
                          features_[static_cast<std::size_t>(feature)].inward.end());
        Eigen::MatrixX3d lhs(static_cast<Eigen::Index>(planes.size()), 3);
        for (std::size_t k = 0; k < planes.size(); ++k) lhs.row(static_cast<Eigen::Index>(k)) = planes[k];
        Eigen::JacobiSVD<Eigen::MatrixXd> svd(lhs, Eigen::ComputeThinU | Eigen::ComputeThinV);
        svd.setThreshold(1e-3);
        return svd.solve(Eigen::VectorXd::Constant(lhs.rows(), offset_.inset()));
    }

    [[nodiscard]] Vec3d direction_to(int v, int feature) const
    {
        const Feature& edge = features_[static_cast<std::size_t>(feature)];
        return (point(v) - point(edge.a == v ? edge.b : edge.a)).normalized();
    }
    [[nodiscard]] const Vec3d& point(int v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }
    [[nodiscard]] const std::vector<int>& at(int v) const { return features_at_[static_cast<std::size_t>(v)]; }
    Feature& of(int feature) { return features_[static_cast<std::size_t>(feature)]; }

    const OffsetSurface& offset_;
    const TriangleMesh& mesh_;
    double step_;
    RunBuilder line_;
    std::vector<Feature> features_;
    std::vector<std::vector<int>> features_at_; ///< per vertex
};

} // namespace

std::vector<OffsetPoint> sample_creases(const OffsetSurface& offset, double spacing)
{
    std::vector<OffsetPoint> samples, kept;
    CreaseWalk walk(offset, spacing);
    for (const Run& run : walk.runs()) sample_run(run, spacing, samples);
    const PointGrid grid(positions_of(samples), spacing);
    std::vector<bool> dropped(samples.size(), false);
    for (std::size_t i = 0; i < samples.size(); ++i) { // lines meet in their corners, and may run close by each other
        grid.for_near(samples[i].position, 0.75 * spacing,
                      [&](std::size_t j, double) { dropped[i] = dropped[i] || (j < i && !dropped[j]); });
        if (!dropped[i]) kept.push_back(samples[i]);
    }
    return kept;
}

} // namespace flotsam
