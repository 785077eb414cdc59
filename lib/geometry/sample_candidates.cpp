#include "geometry/sample_candidates.hpp"

#include "geometry/split_mix.hpp"

#include <algorithm>
#include <array>

namespace flotsam {
namespace {

constexpr double kSharpVertex = 0.9962; ///< cosine of 5 degrees: flatter vertices have caps too small to matter

/// Hands out `per_area` points a unit of area over a sequence of pieces, carrying fractions over from one to the next.
class Quota {
  public:
    Quota(double per_area, SplitMix& random) : per_area_(per_area), owed_(random.uniform()) {}
    int take(double area)
    {
        owed_ += per_area_ * area;
        const double whole = std::floor(owed_);
        owed_ -= whole;
        return static_cast<int>(whole);
    }

  private:
    double per_area_, owed_;
};

/// Leaves of a convex polygon what lies in the box. **Source:** Sutherland & Hodgman 1974.
void clip_polygon(const Aabb& box, std::vector<Vec3d>& polygon)
{
    std::vector<Vec3d> kept;
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const double sign = side % 2 == 0 ? 1.0 : -1.0, border = side % 2 == 0 ? box.min[axis] : -box.max[axis];
        const auto depth = [&](const Vec3d& p) { return sign * p[axis] - border; };
        kept.clear();
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Vec3d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
            const double at_p = depth(p), at_q = depth(q);
            if (at_p >= 0.0) kept.push_back(p);
            if ((at_p < 0.0) != (at_q < 0.0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
        }
        polygon.swap(kept);
    }
}

class Sampler {
  public:
    Sampler(const OffsetSurface& offset, double per_area, std::uint64_t seed, const Aabb& region)
        : offset_(offset), mesh_(offset.surface().mesh()), random_(seed), quota_(per_area, random_), region_(region)
    {
        result_.area_each = 1.0 / per_area;
    }

    SampleCandidates sample()
    {
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) sample_triangle(t);
        if (offset_.inset() > 0.0) sample_bends();
        return std::move(result_);
    }

  private:
    void sample_triangle(std::size_t t)
    {
        const std::array<Vec3d, 3> corners = {mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2)};
        Aabb box;
        for (const Vec3d& corner : corners) box.extend(corner);
        if (region_.contains(box.min) && region_.contains(box.max)) return sample_below(corners, t);
        if (!(box.min.array() <= region_.max.array()).all() || !(box.max.array() >= region_.min.array()).all()) return;
        polygon_.assign(corners.begin(), corners.end());
        clip_polygon(region_, polygon_);
        add_cuts();
        for (std::size_t k = 2; k < polygon_.size(); ++k) sample_below({polygon_[0], polygon_[k - 1], polygon_[k]}, t);
    }

    void add_cuts()
    {
        for (std::size_t k = 0; k < polygon_.size(); ++k) {
            const Vec3d &p = polygon_[k], &q = polygon_[(k + 1) % polygon_.size()];
            for (int side = 0; side < 6; ++side) {
                const int axis = side / 2;
                const double border = side % 2 == 0 ? region_.min[axis] : region_.max[axis];
                const double near = 1e-9 * std::max(1.0, std::abs(border));
                if (std::abs(p[axis] - border) < near && std::abs(q[axis] - border) < near)
                    result_.cut[static_cast<std::size_t>(side)] += (q - p).norm();
            }
        }
    }

    /// Of the triangle t, or a triangle in it.
    void sample_below(const std::array<Vec3d, 3>& corners, std::size_t t)
    {
        const Vec3d a = corners[0], ab = corners[1] - a, ac = corners[2] - a;
        const Vec3d inward = offset_.inward(t);
        for (int count = quota_.take(0.5 * ab.cross(ac).norm()); count > 0; --count) {
            double u = random_.uniform(), v = random_.uniform();
            if (u + v > 1.0) {
                u = 1.0 - u;
                v = 1.0 - v;
            }
            const Vec3d base = a + u * ab + v * ac;
            if (const auto point = offset_.below(base, inward)) {
                result_.points.push_back(*point);
            } else {
                result_.bare.push_back({base, inward});
            }
        }
    }

    void sample_bends()
    {
        const MeshTopology& topology = offset_.topology();
        std::vector<Vec3d> axis(mesh_.vertices.size(), Vec3d::Zero()); // between the directions around a bent vertex
        std::vector<double> bend(mesh_.vertices.size(), 1.0);          // cosine of the sharpest
        for (const MeshEdge& edge : topology.edges) {
            if (edge.triangles != 2) continue;
            const Vec3d left = offset_.inward(static_cast<std::size_t>(edge.left));
            const Vec3d right = offset_.inward(static_cast<std::size_t>(edge.right));
            const Vec3d a = vertex(edge.a), b = vertex(edge.b);
            const bool reflex = left.dot(vertex(edge.apex) - a) < 0.0;
            if (reflex) sample_arc(a, b, left, right);
            for (int v : {edge.a, edge.b}) {
                axis[static_cast<std::size_t>(v)] += left + right;
                if (reflex)
                    bend[static_cast<std::size_t>(v)] = std::min(bend[static_cast<std::size_t>(v)], left.dot(right));
            }
        }
        std::vector<double> widest(mesh_.vertices.size(), 1.0); // least cosine of a direction with the axis
        for (Vec3d& direction : axis) direction.normalize();
        for (const MeshEdge& edge : topology.edges)
            for (int v : {edge.a, edge.b})
                for (int t : {edge.left, edge.right})
                    if (t >= 0) {
                        const auto at = static_cast<std::size_t>(v);
                        widest[at] = std::min(widest[at], axis[at].dot(offset_.inward(static_cast<std::size_t>(t))));
                    }
        for (std::size_t v = 0; v < bend.size(); ++v)
            if (bend[v] < kSharpVertex && !topology.on_boundary[v]) sample_cap(v, axis[v], widest[v]);
    }

    void sample_arc(Vec3d a, Vec3d b, const Vec3d& from, const Vec3d& to)
    {
        if (!clip_segment(region_, a, b)) return;
        const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
        const Vec3d across = (to - from.dot(to) * from).normalized();
        for (int count = quota_.take(angle * offset_.inset() * (b - a).norm()); count > 0; --count) {
            const double turn = angle * random_.uniform();
            accept_exact(a + random_.uniform() * (b - a), std::cos(turn) * from + std::sin(turn) * across);
        }
    }

    void sample_cap(std::size_t v, const Vec3d& axis, double widest)
    {
        if (!region_.contains(mesh_.vertices[v])) return;
        const double inset = offset_.inset(), min_cosine = std::max(widest, -1.0);
        const Quatd turn = Quatd::FromTwoVectors(Vec3d::UnitZ(), axis);
        for (int count = quota_.take(2.0 * std::numbers::pi * (1.0 - min_cosine) * inset * inset); count > 0; --count)
            accept_exact(mesh_.vertices[v], turn * random_.direction_about_z(min_cosine));
    }

    void accept_exact(const Vec3d& base, const Vec3d& direction)
    {
        const double inset = offset_.inset();
        const Vec3d position = base + inset * direction;
        if (offset_.holds(position)) result_.points.push_back({position, direction, inset, false});
    }

    [[nodiscard]] const Vec3d& vertex(int v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }

    const OffsetSurface& offset_;
    const TriangleMesh& mesh_;
    SplitMix random_;
    Quota quota_;
    Aabb region_;
    std::vector<Vec3d> polygon_; ///< scratch
    SampleCandidates result_;
};

} // namespace

bool clip_segment(const Aabb& box, Vec3d& a, Vec3d& b)
{
    const Vec3d way = b - a;
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        if (way[axis] == 0.0) {
            if (a[axis] < box.min[axis] || a[axis] > box.max[axis]) return false;
            continue;
        }
        const double low = (box.min[axis] - a[axis]) / way[axis], high = (box.max[axis] - a[axis]) / way[axis];
        first = std::max(first, std::min(low, high));
        last = std::min(last, std::max(low, high));
    }
    if (!(first < last)) return false;
    if (last < 1.0) b = a + last * way;
    if (first > 0.0) a += first * way;
    return true;
}

SampleCandidates sample_candidates(const OffsetSurface& offset, double per_area, std::uint64_t seed, const Aabb& region)
{
    return Sampler(offset, per_area, seed, region).sample();
}

} // namespace flotsam
