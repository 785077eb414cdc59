#pragma once

#include "flotsam/geometry/surface_samples.hpp"

namespace flotsam {

/// The sides of a sheet; none: it is no sheet.
struct SheetSides {
    std::vector<TriangleMesh> sides; ///< open meshes with the water in front of their triangles
    double thickness = 0.0;          ///< mean distance of opposite faces [m]
};

/// Of what has water on both sides the mesh and its reverse; of a shell that is thinner than two insets (at a fifth of
/// its surface or more) the parts of its surface that hang together when the narrow rims between opposite faces are
/// left out. None for a solid whose opposite faces hang together otherwise, too (rods, wedges), and for thick ones:
/// their samples lie in their middle. In two dimensions of the outline in the plane y = 0.
[[nodiscard]] SheetSides sheet_sides(const SurfaceQuery& surface, const SurfaceSampleSettings& settings);

} // namespace flotsam
