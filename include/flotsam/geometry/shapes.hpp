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

/// Sizes of a Wigley hull, the parabolic hull with which ship hydrodynamics compares itself:
///     y = +-(B/2) (1 - (2x/L)^2) (1 - (z/T)^2),   -T <= z <= 0,
/// and above the water line z = 0 upright sides up to a flat deck. Under the water line its volume is (4/9) L B T and
/// its centre 3T/8 deep; the water line bounds (2/3) L B, whose second moment about x is (4/105) L B^3.
/// **Source:** Wigley 1934. **Differs:** the sides above the water line.
struct WigleyHull {
    double length = 1.0;    ///< L [m], along x
    double breadth = 0.2;   ///< B [m], along y
    double draft = 0.1;     ///< T [m]
    double freeboard = 0.0; ///< height of the deck over the water line [m], >= 0
};

/// Closed mesh of the hull in `stations` pieces along it and `levels` from the keel up to the water line, with as high
/// pieces above it. Its vertices lie on the hull, so it has a little less volume. Throws std::invalid_argument for
/// sizes that are not > 0 and for fewer than two stations or one level.
[[nodiscard]] TriangleMesh wigley_hull(const WigleyHull& hull, int stations, int levels);

/// The inside of a box as a wall: the sides that are not open, two triangles each, facing outward (away from the
/// water). `open`: any of "-x" "+x" "-y" "+y" "-z" "+z", but not all. Throws std::invalid_argument for other names
/// and for an empty box.
[[nodiscard]] TriangleMesh container_box(const Aabb& box, const std::vector<std::string>& open);

} // namespace flotsam
