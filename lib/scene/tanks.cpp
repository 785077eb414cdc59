#include "scene/tanks.hpp"

#include "scene/refuse.hpp"
#include "world/box_rooms.hpp"

#include <algorithm>

namespace flotsam::scene {
namespace {

/// Spacings: the support of the kernel, and the layer of samples behind each wall.
constexpr double kLeastGap = 4.0;

} // namespace

std::optional<double> gap_of_tanks(const SceneFile& scene, std::size_t a, std::size_t b)
{
    const SceneWall &one = scene.walls[a], &other = scene.walls[b];
    if (a == b || one.mesh || other.mesh) return std::nullopt;
    return parted_by(one.box, open_sides(one.open), other.box, open_sides(other.open), scene.dimensions);
}

std::vector<std::vector<std::size_t>> tanks_of_boxes(const SceneFile& scene)
{
    std::vector<std::vector<std::size_t>> tanks;
    for (std::size_t k = 0; k < scene.walls.size(); ++k) {
        if (scene.walls[k].mesh) continue;
        std::vector<std::size_t> walls;
        for (std::size_t other = 0; other < scene.walls.size(); ++other)
            if (!scene.walls[other].mesh && !gap_of_tanks(scene, k, other)) walls.push_back(other);
        // What goes around several tanks is in none of them.
        const bool is_one = std::none_of(walls.begin(), walls.end(), [&](std::size_t a) {
            return std::any_of(walls.begin(), walls.end(), [&](std::size_t b) { return gap_of_tanks(scene, a, b); });
        });
        if (is_one && std::find(tanks.begin(), tanks.end(), walls) == tanks.end()) tanks.push_back(std::move(walls));
    }
    return tanks;
}

void check_gaps_of_tanks(const SceneFile& scene, const PreparedScene& prepared)
{
    const double least = kLeastGap * scene.particle_spacing;
    for (std::size_t b = 0; b < scene.walls.size(); ++b)
        for (std::size_t a = 0; a < b; ++a) {
            const std::optional<double> gap = gap_of_tanks(scene, a, b);
            if (!gap || *gap > least - 1e-9) continue;
            refuse(scene, prepared.walls[a].name, " and ", prepared.walls[b].name, " are tanks ", 1000.0 * *gap,
                   " mm apart, and need 4 particle spacings (", 1000.0 * least,
                   " mm) between them; basins on both sides of a thin wall are one box with a dam, which is a mesh or "
                   "a fixed body");
        }
}

} // namespace flotsam::scene
