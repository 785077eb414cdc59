#pragma once

#include "flotsam/core/types.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace flotsam {

inline Vec3d closest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b)
{
    const Vec3d ab = b - a;
    const double length_sq = ab.squaredNorm();
    if (!(length_sq > 0.0)) return a;
    return a + std::clamp(ab.dot(p - a) / length_sq, 0.0, 1.0) * ab;
}

/// Closest point of triangle a, b, c; degenerate triangles count as their edges.
/// **Source:** Ericson 2005, "Real-Time Collision Detection", 5.1.5.
inline Vec3d closest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    const Vec3d ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) return a;
    const Vec3d bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return closest_on_segment(p, a, b);
    const Vec3d cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return closest_on_segment(p, a, c);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) return closest_on_segment(p, b, c);
    const double sum = va + vb + vc;
    if (sum > 0.0) return a + ab * (vb / sum) + ac * (vc / sum);

    Vec3d on_ab = closest_on_segment(p, a, b), on_bc = closest_on_segment(p, b, c);
    Vec3d on_ca = closest_on_segment(p, c, a);
    const double ab_sq = (p - on_ab).squaredNorm(), bc_sq = (p - on_bc).squaredNorm(),
                 ca_sq = (p - on_ca).squaredNorm();
    if (ab_sq <= bc_sq && ab_sq <= ca_sq) return on_ab;
    return bc_sq <= ca_sq ? on_bc : on_ca;
}

/// Solid angle under which p sees triangle a, b, c [sr], positive from behind (against the normal).
/// **Source:** Van Oosterom & Strackee 1983.
inline double solid_angle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    const Vec3d pa = a - p, pb = b - p, pc = c - p;
    const double la = pa.norm(), lb = pb.norm(), lc = pc.norm();
    const double triple = pa.dot(pb.cross(pc));
    const double rest = la * lb * lc + pa.dot(pb) * lc + pb.dot(pc) * la + pc.dot(pa) * lb;
    return 2.0 * std::atan2(triple, rest);
}

/// A line seen along itself: projects points to the plane across it, so that triangles that share an edge agree
/// exactly on which side of it the line passes. **Source:** Woop, Benthin & Wald 2013.
class LineView {
  public:
    LineView(const Vec3d& from, const Vec3d& direction) : from_(from)
    {
        direction.cwiseAbs().maxCoeff(&z_);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        shear_x_ = direction[x_] / direction[z_];
        shear_y_ = direction[y_] / direction[z_];
    }

    /// Does the line pass through the triangle, its edges and corners included? `slack` is relative.
    [[nodiscard]] bool crosses(const Vec3d& a, const Vec3d& b, const Vec3d& c, double slack) const
    {
        const Eigen::Vector2d pa = project(a), pb = project(b), pc = project(c);
        const double u = cross(pc, pb), v = cross(pa, pc), w = cross(pb, pa);
        const double extent = std::max({pa.squaredNorm(), pb.squaredNorm(), pc.squaredNorm()});
        const double allowed = slack * extent;
        return (u >= -allowed && v >= -allowed && w >= -allowed) || (u <= allowed && v <= allowed && w <= allowed);
    }

  private:
    [[nodiscard]] Eigen::Vector2d project(const Vec3d& p) const
    {
        const Vec3d q = p - from_;
        return {q[x_] - shear_x_ * q[z_], q[y_] - shear_y_ * q[z_]};
    }
    static double cross(const Eigen::Vector2d& p, const Eigen::Vector2d& q) { return p.x() * q.y() - p.y() * q.x(); }

    Vec3d from_;
    int x_ = 0, y_ = 1, z_ = 2;
    double shear_x_ = 0.0, shear_y_ = 0.0;
};

} // namespace flotsam
