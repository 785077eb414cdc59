#pragma once

#include "flotsam/geometry/triangle_mesh.hpp"

#include <variant>

namespace flotsam {

struct BoxShape {
    Vec3d edges = Vec3d::Ones(); ///< full edge lengths [m]
};
struct SphereShape {
    double radius = 0.5; ///< [m]
};
struct CylinderShape {
    double radius = 0.5; ///< [m]
    double height = 1.0; ///< [m], axis z
};
/// Two-dimensional disc: a cylinder along y, one metre long, so that volume is per metre of width.
struct DiscShape {
    double radius = 0.5; ///< [m]
};
struct MeshShape {
    TriangleMesh mesh; ///< closed and checked
};

/// A body's geometry about its own origin. A two-dimensional box is a BoxShape one metre long in y.
using Shape = std::variant<BoxShape, SphereShape, CylinderShape, DiscShape, MeshShape>;

/// Closed mesh of the shape with edges around `max_edge` [m]; round shapes have at least 24 segments and are scaled so
/// that the mesh has exactly the shape's volume. A box has 12 triangles and a mesh is returned as it is: see refined.
/// Throws std::invalid_argument for sizes that are not > 0, and for a `max_edge` below 1/5000 of a round shape.
[[nodiscard]] TriangleMesh tessellate(const Shape& shape, double max_edge);

/// The inside of a box as a wall: the sides that are not open, two triangles each, facing outward (away from the
/// water). `open`: any of "-x" "+x" "-y" "+y" "-z" "+z", but not all. Throws std::invalid_argument for other names
/// and for an empty box.
[[nodiscard]] TriangleMesh container_box(const Aabb& box, const std::vector<std::string>& open);

} // namespace flotsam
