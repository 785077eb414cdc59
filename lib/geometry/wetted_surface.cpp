#include "geometry/wetted_surface.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/disjoint_sets.hpp"
#include "geometry/mesh_topology.hpp"
#include "geometry/wetted_triangle.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

constexpr std::size_t kDry = static_cast<std::size_t>(-1);
constexpr int kLevelsTried = 16;

/// Volume between a triangle's part below the water and the water plane, positive where the triangle looks down [m^3].
double column(std::array<Vec3d, 3> corners, double water_level)
{
    for (Vec3d& corner : corners) corner.z() -= water_level;
    const WettedTriangle wet = wetted_part(corners);
    double sum = 0.0;
    for (std::size_t k = 2; k < wet.count; ++k) {
        const Vec3d &a = wet.corners[0], &b = wet.corners[k - 1], &c = wet.corners[k];
        sum += 0.5 * (b - a).cross(c - a).z() * (a.z() + b.z() + c.z()) / 3.0;
    }
    return sum;
}

} // namespace

WettedSurface::WettedSurface(const TriangleMesh& closed, const Pose& pose) : low_(1e300), high_(-1e300)
{
    const std::vector<int> place = topology(closed).first_at_place;
    for (const Vec3d& vertex : closed.vertices) vertices_.push_back(pose.to_world(vertex));
    for (std::array<int, 3> triangle : closed.triangles) {
        for (int& vertex : triangle) {
            vertex = place[static_cast<std::size_t>(vertex)];
            low_ = std::min(low_, vertices_[static_cast<std::size_t>(vertex)].z());
            high_ = std::max(high_, vertices_[static_cast<std::size_t>(vertex)].z());
        }
        triangles_.push_back(triangle);
    }
}

WettedSurface::Parts WettedSurface::parts(double water_level) const
{
    const auto is_below = [&](int vertex) { return vertices_[static_cast<std::size_t>(vertex)].z() < water_level; };
    DisjointSets sets(vertices_.size());
    for (const std::array<int, 3>& t : triangles_)
        for (std::size_t k = 0; k < 3; ++k)
            if (const int a = t[k], b = t[(k + 1) % 3]; is_below(a) && is_below(b))
                sets.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    Parts result{std::vector<std::size_t>(triangles_.size(), kDry), std::vector<double>(vertices_.size(), 0.0)};
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        std::array<Vec3d, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const int vertex = triangles_[t][k];
            corners[k] = vertices_[static_cast<std::size_t>(vertex)];
            if (is_below(vertex)) result.part[t] = sets.find(static_cast<std::size_t>(vertex));
        }
        if (result.part[t] != kDry) result.volume[result.part[t]] += column(corners, water_level);
    }
    return result;
}

std::vector<char> WettedSurface::basins(double water_level) const
{
    const Parts wet = parts(water_level);
    std::vector<char> result(triangles_.size(), 0);
    for (std::size_t t = 0; t < result.size(); ++t)
        result[t] = wet.part[t] != kDry && wet.volume[wet.part[t]] < 0.0 ? 1 : 0;
    return result;
}

bool WettedSurface::has_basin(double water_level) const
{
    const std::vector<double> volumes = parts(water_level).volume;
    return std::any_of(volumes.begin(), volumes.end(), [](double volume) { return volume < 0.0; });
}

double WettedSurface::displacement(double water_level) const
{
    double sum = 0.0;
    for (const double volume : parts(water_level).volume) sum += std::max(volume, 0.0);
    return sum;
}

std::optional<double> WettedSurface::level_of_basins(double water_level) const
{
    if (has_basin(water_level)) return water_level;
    for (int k = kLevelsTried - 1; k > 0; --k) {
        const double level = low_ + k * (high_ - low_) / kLevelsTried;
        if (level <= water_level) break;
        if (has_basin(level)) return level;
    }
    return std::nullopt;
}

std::optional<double> WettedSurface::level_of_displacement(double water_level, double volume) const
{
    constexpr int kSteps = 50, kRounds = 60;
    constexpr double kRounding = 1e-14;
    double step = (high_ - low_) / kSteps;
    const double least_step = 1e-6 * step;
    double low = low_, high = std::clamp(water_level, low_, high_);
    // Her displacement rises with the water until that comes over a rim.
    double below = 0.0, at_high = displacement(high);
    while (at_high < volume) {
        const double next = displacement(high + step);
        if (next <= at_high) {
            step *= 0.5;
            if (step < least_step) return std::nullopt;
            continue;
        }
        low = high;
        below = at_high;
        high += step;
        at_high = next;
    }
    // By regula falsi and halving in turn.
    for (int round = 0; round < kRounds && high - low > kRounding * (high_ - low_); ++round) {
        const double share = round % 2 == 0 && at_high > below ? (volume - below) / (at_high - below) : 0.5;
        const double level = low + std::clamp(share, 1e-3, 1.0 - 1e-3) * (high - low);
        const double found = displacement(level);
        (found < volume ? low : high) = level;
        (found < volume ? below : at_high) = found;
        if (std::abs(found - volume) <= kRounding * volume) return level;
    }
    return high;
}

std::vector<char> basins(const TriangleMesh& closed, const Pose& pose, double water_level)
{
    return WettedSurface(closed, pose).basins(water_level);
}

std::optional<double> vessel_draft(const TriangleMesh& closed, const Pose& pose, double water_level,
                                   double displaced_volume)
{
    require(displaced_volume >= 0.0 && std::isfinite(displaced_volume), "displaced_volume must be >= 0 m^3 and finite",
            displaced_volume);
    const WettedSurface surface(closed, pose);
    const auto level = surface.level_of_displacement(water_level, displaced_volume);
    if (!level) return std::nullopt;
    return *level - surface.low();
}

} // namespace flotsam
