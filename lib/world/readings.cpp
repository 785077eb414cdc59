#include "world/fluid_world_impl.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace flotsam {
namespace {

/// Calls visit(j) for the particles in the cells within `reach` cells of the one of p, as the grid of the last step has
/// them. Particles have moved by less than a spacing since then.
template <class Visit>
void visit_around(const CellGrid& grid, const CellLists& cells, const Vec3d& p, int reach, Visit&& visit)
{
    if (cells.start.empty()) return;
    const Vec4 place(static_cast<Scalar>(p.x()), static_cast<Scalar>(p.y()), static_cast<Scalar>(p.z()), Scalar(0));
    grid.visit_rows(grid.cell_of(place), reach, [&](std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t k = cells.start[first]; k < cells.start[last + 1]; ++k) visit(cells.order[k]);
    });
}

/// How much higher than the passage of the volume fraction through 1/2 the surface is that has all the water under it
/// at rest density [spacings]: the uppermost layers are packed closer than others (Gibbs' dividing surface). Found on
/// still tanks, by the volume of their particles; single ones differ by 0.02 (2-D: 0.04).
double surface_excess(KernelKind kernel, int dimensions)
{
    if (kernel == KernelKind::cubic) return dimensions == 3 ? 0.155 : 0.11;
    return dimensions == 3 ? 0.10 : 0.05;
}

} // namespace

/// Normal stress of the forces between particles around i (their virial) on a face across gravity, which is what a
/// gauge feels:  P_i = rho0 m / 2 sum_j (p_i / rho_i^2 + p_j / rho_j^2) (-(x_ij . e) (grad W_ij . e)),  e along
/// gravity; without gravity the mean over all directions. The p_i themselves are multipliers, a few per cent off it in
/// a settled packing and half as much again in the layer at a wall, which carries all of the wall's force.
/// **Source:** Irving & Kirkwood 1950 for the virial stress.
double FluidWorld::Impl::gauge_pressure(std::size_t i) const
{
    const auto share = [&](std::size_t k) {
        const double rho = static_cast<double>(fluid.density[k]);
        return static_cast<double>(fluid.pressure[k]) / (rho * rho);
    };
    const double g = settings.gravity.norm();
    double sum = 0.0;
    for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k) {
        const std::uint32_t j = fluid_pairs.neighbour(i, k);
        const Vec3d x = (new_position[i] - new_position[j]).head<3>().cast<double>();
        const Vec3d gradient = static_cast<double>(fluid_pairs.slope(k)) * x;
        const double push = g > 0.0 ? -x.dot(settings.gravity) * gradient.dot(settings.gravity) / (g * g)
                                    : -x.dot(gradient) / settings.dimensions;
        sum += (share(i) + share(j)) * push;
    }
    return 0.5 * settings.rest_density * fluid.particle_mass * sum;
}

/// How well the pressure of particle i can be read: in the bulk neither it nor a particle next to it touches a solid.
FluidWorld::Impl::Readable FluidWorld::Impl::readable(std::size_t i) const
{
    const auto touches = [&](std::size_t k) { return boundary_pairs.start[k] != boundary_pairs.start[k + 1]; };
    if (touches(i)) return Readable::any;
    const Scalar next_sq = static_cast<Scalar>(1.25 * 1.25 * spacing() * spacing());
    for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k) {
        const std::uint32_t j = fluid_pairs.neighbour(i, k);
        if (touches(j) && (fluid.position[i] - fluid.position[j]).squaredNorm() < next_sq) return Readable::free;
    }
    return Readable::bulk;
}

double FluidWorld::pressure_at(const Vec3d& point) const
{
    require(point.allFinite(), "a point must be finite [m]");
    const Impl& world = *impl_;
    if (world.fluid_pairs.rows() != world.fluid.size()) return 0.0; // before the first step
    const auto cells_within = [&](double radius) { return static_cast<int>(std::ceil(radius / world.support())); };
    bool is_wet = false;
    visit_around(world.grid, world.fluid_cells, point, cells_within(2.0 * world.spacing()), [&](std::uint32_t j) {
        const Vec3d at = world.fluid.position[j].head<3>().cast<double>();
        is_wet = is_wet || (point - at).norm() < 2.0 * world.spacing();
    });
    if (!is_wet) return 0.0;
    // The layer at a wall and the one that leans on it share its force unevenly: the bulk is asked first, from further
    // away if there is little of it near, then what there is.
    using Readable = Impl::Readable;
    struct Try {
        double reach;      ///< spacings
        Readable least;    ///< of a particle
        double min_filled; ///< volume fraction of the kernel that is enough to go by
    };
    for (const Try& t : {Try{4, Readable::bulk, 0.5}, Try{8, Readable::bulk, 0.02}, Try{8, Readable::free, 0.02},
                         Try{2, Readable::any, 0.1}}) {
        // A flat weight: next to a wall layers lie in turn above and below the mean.
        const double radius = t.reach * world.spacing();
        double weights = 0.0, sum = 0.0;
        visit_around(world.grid, world.fluid_cells, point, cells_within(radius), [&](std::uint32_t j) {
            const Vec3d at = world.fluid.position[j].head<3>().cast<double>();
            const double w = 1.0 - (point - at).squaredNorm() / (radius * radius);
            if (!(w > 0.0) || world.readable(j) < t.least) return;
            const double p = world.gauge_pressure(j);
            const double here =
                p > 0.0 ? p + world.settings.rest_density * world.settings.gravity.dot(point - at) : 0.0;
            weights += w;
            sum += w * std::max(0.0, here);
        });
        const double all = world.settings.dimensions == 3 ? 8.0 / 15.0 * std::numbers::pi * std::pow(radius, 3)
                                                          : 0.5 * std::numbers::pi * radius * radius;
        const double filled = weights * world.fluid.particle_mass / world.settings.rest_density / all;
        if (filled > t.min_filled) return sum / weights;
    }
    return 0.0;
}

std::optional<double> FluidWorld::level_at(double x, double y) const
{
    // Profile of the water's share of what solids leave of the volume, along the vertical line on points a fifth of a
    // spacing apart: each particle within reach adds its kernel to the points near it. The highest passage through 1/2
    // counts.
    const FluidState& fluid = impl_->fluid;
    const double d = impl_->spacing(), h = impl_->support(), dz = 0.2 * d;
    const double excess = d * surface_excess(impl_->settings.kernel, impl_->settings.dimensions);
    std::vector<std::pair<double, double>> near; // height, squared distance from the line
    for (const Vec4& p : fluid.position) {
        const double dx = static_cast<double>(p.x()) - x;
        const double dy = impl_->settings.dimensions == 3 ? static_cast<double>(p.y()) - y : 0.0;
        if (dx * dx + dy * dy < h * h) near.emplace_back(static_cast<double>(p.z()), dx * dx + dy * dy);
    }
    if (near.empty()) return std::nullopt;
    std::sort(near.begin(), near.end(), std::greater<>());
    const double volume = fluid.particle_mass / impl_->settings.rest_density;
    const auto solids_at = [&](double z) {
        const Vec3d point(x, impl_->settings.dimensions == 3 ? y : 0.0, z);
        double solids = 0.0;
        visit_around(impl_->grid, impl_->boundary_cells, point, 1, [&](std::uint32_t b) {
            const double r = (impl_->boundary.position[b].head<3>().cast<double>() - point).norm();
            solids += static_cast<double>(impl_->boundary.volume[b] * impl_->kernel.value(static_cast<Scalar>(r)));
        });
        return solids;
    };
    // Of walls beside the line alone: they are there further down, too, where there is no ceiling, and no floor here.
    const auto left_by_solids = [&](double z) {
        constexpr double kLeast = 0.2; // in the corner of two walls a quarter is left
        return impl_->has_pairs() ? std::max(kLeast, 1.0 - std::min(solids_at(z), solids_at(z - h))) : 1.0;
    };
    const auto fraction = [&](double z) {
        double sum = 0.0;
        for (const auto& [height, away_sq] : near) {
            if (std::abs(height - z) >= h) continue;
            const double r = std::sqrt(away_sq + (height - z) * (height - z));
            sum += volume * static_cast<double>(impl_->kernel.value(static_cast<Scalar>(r)));
        }
        return sum > 0.0 ? sum / left_by_solids(z) : 0.0;
    };
    double above = 0.0;
    const double lowest = near.back().first - h;
    for (double z = near.front().first + h; z > lowest; z -= dz) {
        const double here = fraction(z);
        if (here >= 0.5) return excess + z + dz * (here - 0.5) / std::max(here - above, 1e-12);
        above = here;
    }
    return std::nullopt;
}

} // namespace flotsam
