#pragma once

#include "flotsam/core/types.hpp"

#include <array>
#include <string>
#include <vector>

namespace flotsam {

/// Triangles with shared vertices. A closed mesh has its triangles counter-clockwise as seen from outside the solid.
struct TriangleMesh {
    std::vector<Vec3d> vertices;               ///< [m]
    std::vector<std::array<int, 3>> triangles; ///< indices into vertices
    std::vector<int> part_of_triangle;         ///< index into part_names, or empty: one part
    std::vector<std::string> part_names;       ///< as the file names them

    [[nodiscard]] bool empty() const { return triangles.empty(); }
    [[nodiscard]] Vec3d corner(std::size_t triangle, int k) const
    {
        return vertices[static_cast<std::size_t>(triangles[triangle][static_cast<std::size_t>(k)])];
    }
};

/// Smallest axis-aligned box around the mesh's vertices.
[[nodiscard]] Aabb bounds(const TriangleMesh& mesh);

/// The mesh with every vertex placed by `pose`.
[[nodiscard]] TriangleMesh transformed(TriangleMesh mesh, const Pose& pose);

/// The mesh with the order of every triangle's corners reversed.
[[nodiscard]] TriangleMesh flipped(TriangleMesh mesh);

/// Both meshes in one; parts stay apart.
[[nodiscard]] TriangleMesh joined(TriangleMesh a, const TriangleMesh& b);

/// Triangles split (at edge midpoints, watertight) until no edge is longer than `max_edge` [m], > 0.
[[nodiscard]] TriangleMesh refined(TriangleMesh mesh, double max_edge);

} // namespace flotsam
