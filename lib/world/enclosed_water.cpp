#include "world/enclosed_water.hpp"

#include "world/next_to.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

constexpr double kSteep = 0.4;     ///< rest densities a spacing; a flat surface has 0.45 to 0.6, a wall 0 to 0.35
constexpr double kSurfaces = 0.15; ///< of the particles on a face of a cube of the water: less is roughness of solids

} // namespace

double EnclosedWater::mean_shift(const Water& water, std::span<const Vec4> shift)
{
    const std::size_t n = water.position.size();
    sets_.reset(n);
    for (std::uint32_t i = 0; i < n; ++i)
        visit_next_to(water.position, water.pairs, water.particle_spacing, i,
                      [&](std::uint32_t j) { sets_.join(i, j); });
    const double steep = kSteep * water.rest_density / water.particle_spacing;
    bodies_.assign(n, Body{});
    for (std::size_t i = 0; i < n; ++i) {
        Body& body = bodies_[sets_.find(i)];
        ++body.particles;
        body.length += static_cast<double>(shift[i].head<3>().norm());
        if (static_cast<double>(water.own_gradient[i].head<3>().norm()) > steep) ++body.at_surface;
    }
    const double power = 1.0 - 1.0 / water.dimensions;
    double largest = 0.0;
    for (const Body& body : bodies_) {
        const auto count = static_cast<double>(body.particles);
        if (body.particles == 0 || static_cast<double>(body.at_surface) > kSurfaces * std::pow(count, power)) continue;
        largest = std::max(largest, body.length / count);
    }
    return largest;
}

} // namespace flotsam
