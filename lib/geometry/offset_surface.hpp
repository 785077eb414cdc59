#pragma once

#include "flotsam/geometry/surface_samples.hpp"
#include "geometry/mesh_topology.hpp"

#include <optional>

namespace flotsam {

/// A point of the surface that lies `inset` deep in the solid.
struct OffsetPoint {
    Vec3d position = Vec3d::Zero();
    Vec3d direction = Vec3d::Zero(); ///< unit, from the surface into the solid
    double depth = 0.0;              ///< [m] below the surface
    bool thin = false;               ///< in the middle of a part thinner than two insets
};

/// The surface `inset` deep in the solid: all points of that distance from the mesh on the solid's side, and the
/// middle of parts thinner than two insets. It ends where the sheet that bears it ends: no arcs beyond a rim.
class OffsetSurface {
  public:
    OffsetSurface(const SurfaceQuery& surface, const SurfaceSampleSettings& settings);

    /// The point straight below `base`, if the surface reaches there.
    [[nodiscard]] std::optional<OffsetPoint> below(const Vec3d& base, const Vec3d& direction) const;

    /// The point of the offset surface near `position`, found from a near-by one.
    [[nodiscard]] std::optional<OffsetPoint> project(const Vec3d& position, const OffsetPoint& from) const;

    /// The deepest point (at most `inset` deep) uphill from below `base`: for parts thin in two directions and more.
    [[nodiscard]] OffsetPoint deepest_below(const Vec3d& base, const Vec3d& direction) const;

    /// Does the point lie exactly `inset` deep in the solid?
    [[nodiscard]] bool holds(const Vec3d& position) const;

    /// Unit direction into the solid at a triangle.
    [[nodiscard]] Vec3d inward(std::size_t triangle) const { return side_ * normals_[triangle]; }

    [[nodiscard]] const SurfaceQuery& surface() const { return surface_; }
    [[nodiscard]] const MeshTopology& topology() const { return topology_; }
    [[nodiscard]] double inset() const { return inset_; }

  private:
    [[nodiscard]] bool at_rim(const SurfaceQuery::Closest& nearest) const;
    [[nodiscard]] Vec3d direction_at(const Vec3d& position, const SurfaceQuery::Closest& nearest) const;

    const SurfaceQuery& surface_;
    MeshTopology topology_;
    std::vector<Vec3d> normals_;
    double inset_;
    double side_;
    bool inside_;
    bool has_rim_ = false;
};

} // namespace flotsam
