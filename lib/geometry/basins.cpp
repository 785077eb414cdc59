#include "flotsam/geometry/hydrostatics.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/disjoint_sets.hpp"
#include "geometry/mesh_topology.hpp"
#include "geometry/submerged_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flotsam {
namespace {

/// The parts of a surface below the water that hang together there.
struct WettedParts {
    static constexpr std::size_t kDry = static_cast<std::size_t>(-1);

    std::vector<std::size_t> part; ///< of each triangle; kDry: it is above the water
    std::vector<double> volume;    ///< that each part bounds with the water plane [m^3]; < 0: outside of the solid
};

/// Volume between a triangle's part below the water and the water plane, positive where the triangle looks down [m^3].
double column(const std::array<Vec3d, 3>& corners, double water_level)
{
    std::array<Vec3d, 4> wet; // of three corners at most two are below with two crossings, or three
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d &a = corners[k], &b = corners[(k + 1) % 3];
        const double depth_a = water_level - a.z(), depth_b = water_level - b.z();
        if (depth_a > 0.0) wet[count++] = a;
        if ((depth_a > 0.0) != (depth_b > 0.0)) wet[count++] = a + depth_a / (depth_a - depth_b) * (b - a);
    }
    double sum = 0.0;
    for (std::size_t k = 2; k < count; ++k) {
        const Vec3d area = 0.5 * (wet[k - 1] - wet[0]).cross(wet[k] - wet[0]);
        sum -= area.z() * (water_level - (wet[0].z() + wet[k - 1].z() + wet[k].z()) / 3.0);
    }
    return sum;
}

WettedParts wetted_parts(const TriangleMesh& mesh, const Pose& pose, double water_level)
{
    const std::vector<int> place = topology(mesh).first_at_place;
    std::vector<char> is_below(mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        is_below[v] = pose.to_world(mesh.vertices[v]).z() < water_level ? 1 : 0;
    const auto vertex = [&](std::size_t t, std::size_t k) {
        return static_cast<std::size_t>(place[static_cast<std::size_t>(mesh.triangles[t][k])]);
    };
    DisjointSets sets(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t a = vertex(t, k), b = vertex(t, (k + 1) % 3);
            if (is_below[a] != 0 && is_below[b] != 0) sets.join(a, b);
        }
    WettedParts result{std::vector<std::size_t>(mesh.triangles.size(), WettedParts::kDry),
                       std::vector<double>(mesh.vertices.size(), 0.0)};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k)
            if (const std::size_t v = vertex(t, k); is_below[v] != 0) result.part[t] = sets.find(v);
        if (result.part[t] == WettedParts::kDry) continue;
        const std::array<Vec3d, 3> corners = {pose.to_world(mesh.corner(t, 0)), pose.to_world(mesh.corner(t, 1)),
                                              pose.to_world(mesh.corner(t, 2))};
        result.volume[result.part[t]] += column(corners, water_level);
    }
    return result;
}

/// What the mesh displaces, its basins included [m^3].
double displacement(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    double sum = 0.0;
    for (const double volume : wetted_parts(closed, pose, water_level).volume) sum += std::max(volume, 0.0);
    return sum;
}

} // namespace

std::vector<char> basins(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    const WettedParts wetted = wetted_parts(closed, pose, water_level);
    std::vector<char> result(closed.triangles.size(), 0);
    for (std::size_t t = 0; t < result.size(); ++t)
        result[t] = wetted.part[t] != WettedParts::kDry && wetted.volume[wetted.part[t]] < 0.0 ? 1 : 0;
    return result;
}

std::optional<double> vessel_draft(const TriangleMesh& closed, const Pose& pose, double water_level,
                                   double displaced_volume)
{
    require(displaced_volume >= 0.0 && std::isfinite(displaced_volume), "displaced_volume must be >= 0 m^3 and finite",
            displaced_volume);
    constexpr int kSteps = 200, kHalvings = 50;
    const HeightRange range = height_range(closed, pose);
    double step = (range.high - range.low) / kSteps;
    const double least_step = 1e-6 * step;
    double low = range.low, high = std::clamp(water_level, range.low, range.high);
    // Her displacement rises with the water until that comes over a rim.
    for (double at_high = displacement(closed, pose, high); at_high < displaced_volume;) {
        const double next = displacement(closed, pose, high + step);
        if (next <= at_high) {
            step *= 0.5;
            if (step < least_step) return std::nullopt;
            continue;
        }
        low = high;
        high += step;
        at_high = next;
    }
    for (int k = 0; k < kHalvings; ++k) {
        const double middle = 0.5 * (low + high);
        (displacement(closed, pose, middle) < displaced_volume ? low : high) = middle;
    }
    return high - range.low;
}

} // namespace flotsam
