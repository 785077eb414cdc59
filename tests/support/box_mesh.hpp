#pragma once

#include "flotsam/geometry/shapes.hpp"

namespace flotsam::test {

/// A closed box where it lies in the world.
inline TriangleMesh box_mesh(const Aabb& box)
{
    return transformed(tessellate(BoxShape{box.size()}, 1.0), {box.center(), Quatd::Identity()});
}

} // namespace flotsam::test
