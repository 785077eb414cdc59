#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <memory>
#include <optional>

namespace flotsam {

/// Distance, side and sweep queries against the surface of one triangle mesh (FCL behind it). FCL knows no inside for a
/// mesh: the sign comes from the winding number. Const calls are safe from several threads at once.
class SurfaceQuery {
  public:
    /// The mesh is copied. Throws std::invalid_argument for a mesh without triangles.
    explicit SurfaceQuery(const TriangleMesh& mesh);
    ~SurfaceQuery();
    SurfaceQuery(SurfaceQuery&&) noexcept;
    SurfaceQuery& operator=(SurfaceQuery&&) noexcept;
    SurfaceQuery(const SurfaceQuery&) = delete;
    SurfaceQuery& operator=(const SurfaceQuery&) = delete;

    [[nodiscard]] const TriangleMesh& mesh() const;
    [[nodiscard]] const Aabb& bounds() const;
    /// Unit normal of a triangle, to its counter-clockwise side; 0 of one without area.
    [[nodiscard]] const Vec3d& normal(int triangle) const;

    struct Closest {
        double distance = 0.0;       ///< [m], >= 0
        Vec3d point = Vec3d::Zero(); ///< on the surface
        int triangle = -1;
    };
    /// Closest point of the surface.
    [[nodiscard]] Closest closest(const Vec3d& point) const;

    /// Generalized winding number: 1 inside a closed outward mesh, 0 outside, in between near an open one. Exact for up
    /// to 64 triangles, to about 0.03 for more.
    /// **Source:** Jacobson et al. 2013; Barill et al. 2018 for the tree.
    [[nodiscard]] double winding_number(const Vec3d& point) const;

    /// Winding number > 1/2.
    [[nodiscard]] bool inside(const Vec3d& point) const { return winding_number(point) > 0.5; }

    /// Distance to the surface, negative inside.
    [[nodiscard]] double signed_distance(const Vec3d& point) const;

    struct Hit {
        double fraction = 0.0;        ///< of the way from `from` to `to`, in [0, 1]
        Vec3d normal = Vec3d::Zero(); ///< of the triangle that was hit, pointing against the motion
        int triangle = -1;
    };
    /// First place where a point going straight from `from` to `to` crosses the surface, if it does. Edges and corners
    /// of triangles count, and so does a start or an end on the surface (to 1e-13 of the coordinates), so that no path
    /// of several sweeps gets through unseen; moving within a triangle's plane does not.
    [[nodiscard]] std::optional<Hit> sweep(const Vec3d& from, const Vec3d& to) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotsam
