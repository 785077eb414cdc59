#pragma once

#include "geometry/mesh_topology.hpp"
#include "geometry/sheet_sides.hpp"

#include <array>
#include <vector>

namespace flotsam {

/// Where a sheet is, as seen from a point near it.
struct SheetView {
    Vec3d place = Vec3d::Zero(); ///< of the sheet, closest to the point [m]
    Vec3d normal =
        Vec3d::Zero();       ///< unit, from there to the point; of a point that lies in the solid, from it to there
    int side = kFar;         ///< of the sheet, in front of which the point is
    double beyond_rim = 0.0; ///< from 0, in front of the face, to 1, half a spacing beyond its rim

    static constexpr int kFar = -1; ///< the sheet is out of reach
    [[nodiscard]] bool is_near() const { return side != kFar; }
};

/// Whether two points near a sheet look at the same side of it and at no opposite faces, or into a fold or a gap, each
/// in front of the other's face. `slack` [m]: lengths that are taken for 0.
[[nodiscard]] bool on_one_side(const SheetView& a, const SheetView& b, double slack);

/// One side of a sheet: an open surface with the water in front of it.
class SheetSide {
  public:
    explicit SheetSide(const TriangleMesh& mesh);

    struct Foot {
        Vec3d place = Vec3d::Zero(); ///< closest to the point
        double height = 0.0;         ///< distance, negative behind the surface
        double beyond_rim = 0.0;     ///< distance from the normal at the rim [m]; 0 elsewhere
    };
    /// What is in front is told at edges and vertices by the normals of all triangles there.
    /// **Source:** Baerentzen & Aanaes 2005 (angle-weighted pseudonormals).
    [[nodiscard]] Foot foot_of(const Vec3d& point) const;

  private:
    struct Feature {
        Vec3d normal;
        bool is_rim;
    };
    [[nodiscard]] Feature feature_at(const Vec3d& place, std::size_t triangle) const;

    SurfaceQuery query_;
    std::vector<Vec3d> normal_;                     ///< of triangles, unit
    std::vector<std::array<Vec3d, 3>> edge_normal_; ///< of each triangle, of the edge from corner k to k + 1
    std::vector<Vec3d> vertex_normal_;
    std::vector<bool> vertex_at_rim_;
    MeshTopology topology_;
};

/// A sheet with all its sides.
class Sheet {
  public:
    /// `spacing` of the particles [m].
    Sheet(const SheetSides& sides, double spacing);

    [[nodiscard]] double thickness() const { return thickness_; } ///< [m]
    /// Seen from a point within `reach` [m] of it.
    [[nodiscard]] SheetView view_from(const Vec3d& point, double reach) const;

  private:
    std::vector<SheetSide> sides_;
    Aabb bounds_;
    double thickness_, spacing_;
};

} // namespace flotsam
