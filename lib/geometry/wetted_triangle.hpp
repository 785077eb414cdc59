#pragma once

#include "flotsam/core/types.hpp"

#include <array>

namespace flotsam {

/// What is left of a triangle below z = 0: up to four corners, in the triangle's order.
struct WettedTriangle {
    std::array<Vec3d, 4> corners;
    std::size_t count = 0;
    void add(const Vec3d& corner) { corners[count++] = corner; }
};

/// Where an edge meets z = 0; always reckoned from its lower end, so that both its triangles find the same point.
inline Vec3d crossing_of_water(const Vec3d& a, const Vec3d& b)
{
    const Vec3d& low = a.z() < b.z() ? a : b;
    const Vec3d& high = a.z() < b.z() ? b : a;
    Vec3d point = low + (high - low) * (low.z() / (low.z() - high.z()));
    point.z() = 0.0;
    return point;
}

[[nodiscard]] inline WettedTriangle wetted_part(const std::array<Vec3d, 3>& triangle)
{
    WettedTriangle wetted;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& a = triangle[k];
        const Vec3d& b = triangle[(k + 1) % 3];
        if (a.z() <= 0.0) wetted.add(a);
        if ((a.z() < 0.0 && b.z() > 0.0) || (a.z() > 0.0 && b.z() < 0.0)) wetted.add(crossing_of_water(a, b));
    }
    return wetted;
}

} // namespace flotsam
