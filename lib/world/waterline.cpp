#include "world/fluid_world_impl.hpp"

#include "flotsam/core/contracts.hpp"
#include "world/body_basins.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flotsam {
namespace {

/// Lines over the water, and which of them count.
struct Sounding {
    bool is_fine;              ///< many lines
    double away;               ///< from circles around the bodies [spacings]; < 0: wherever
    double clear;              ///< least distance of a level from a body [spacings]
    std::size_t fewest_levels; ///< that make a water line
};

/// Away from bodies first; in a narrow tank, nearer. Where circles around the bodies cover the whole tank: what lies
/// open between them.
constexpr std::array kSoundings{Sounding{false, 4.0, 1.0, 4}, Sounding{false, 2.0, 1.0, 4},
                                Sounding{false, 1.0, 1.0, 4}, Sounding{true, -1.0, 1.0, 1},
                                Sounding{true, -1.0, 0.5, 1}};

/// Of some levels, at least one.
double median(std::vector<double> levels)
{
    const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 2);
    std::nth_element(levels.begin(), middle, levels.end());
    return *middle;
}

} // namespace

/// Whether the vertical line through (x, y) passes a body nearer than `away` spacings; by circles around the bodies, of
/// 0.7 of their radius for the smallest distances.
bool FluidWorld::Impl::line_passes_body(std::span<const BodyState> at, double x, double y, double away) const
{
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (!bodies[k].query) continue; // removed
        const Aabb box = bodies[k].query->bounds();
        Vec3d corner = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs());
        if (settings.dimensions == 2) corner.y() = 0.0;
        const double radius = corner.norm();
        const Vec3d& c = at[k].pose.position;
        const double reach = (away > 1.0 ? radius : 0.7 * radius) + away * spacing();
        if (std::hypot(x - c.x(), settings.dimensions == 2 ? 0.0 : y - c.y()) < reach) return true;
    }
    return false;
}

/// Whether a body's surface is nearer than `away` spacings.
bool FluidWorld::Impl::touches_body(std::span<const BodyState> at, const Vec3d& point, double away) const
{
    const double reach = away * spacing();
    for (std::size_t k = 0; k < at.size(); ++k) {
        if (!bodies[k].query) continue; // removed
        const SurfaceQuery& query = *bodies[k].query;
        const Vec3d local = at[k].pose.to_body(point);
        if (query.bounds().inflated(reach).contains(local) && query.signed_distance(local) < reach) return true;
    }
    return false;
}

/// Calls visit(x, y, level) for each line that counts.
template <class Visit>
void FluidWorld::Impl::sound(const FluidWorld& world, std::span<const BodyState> at, bool is_fine, double away,
                             double clear, Visit&& visit) const
{
    const bool plane = settings.dimensions == 2;
    Aabb around;
    for (const Vec4& p : fluid.position) around.extend(p.head<3>().cast<double>());
    const int nx = plane ? (is_fine ? 192 : 48) : is_fine ? 32 : 12, ny = plane ? 1 : nx;
    for (int ix = 0; ix < nx; ++ix) {
        for (int iy = 0; iy < ny; ++iy) {
            const double x = around.min.x() + (ix + 0.5) / nx * around.size().x();
            const double y = plane ? 0.0 : around.min.y() + (iy + 0.5) / ny * around.size().y();
            if (away >= 0.0 && line_passes_body(at, x, y, away)) continue;
            const auto level = world.level_at(x, y);
            // Under a body the level is its underside, which it touches.
            if (level && !touches_body(at, Vec3d(x, y, *level), clear)) visit(x, y, *level);
        }
    }
}

std::optional<double> FluidWorld::waterline(std::span<const BodyState> states) const
{
    if (impl_->fluid.size() == 0) return std::nullopt;
    for (const Sounding& sounding : kSoundings) {
        std::vector<double> levels;
        impl_->sound(*this, states, sounding.is_fine, sounding.away, sounding.clear,
                     [&](double, double, double level) { levels.push_back(level); });
        if (levels.size() >= sounding.fewest_levels) return median(std::move(levels));
    }
    return std::nullopt;
}

/// Whether the pairs are those of the particles and samples that there are: not before the first step, nor after a
/// removal until the next one.
bool FluidWorld::Impl::has_pairs() const
{
    return fluid_pairs.rows() == fluid.size() && boundary_pairs.rows() == fluid.size() &&
           paired_samples == boundary.size();
}

/// Whether a wall lies between two points.
bool FluidWorld::Impl::wall_parts(const Vec3d& a, const Vec3d& b) const
{
    return std::any_of(walls.begin(), walls.end(),
                       [&](const Wall& wall) { return wall.query && wall.query->sweep(a, b).has_value(); });
}

/// The particles on the vertical line through (x, y), which are not `beyond` [spacings] from it.
std::vector<std::uint32_t> FluidWorld::Impl::column_at(double x, double y, double beyond) const
{
    const double reach = beyond * spacing();
    std::vector<std::uint32_t> column;
    for (std::uint32_t i = 0; i < fluid.size(); ++i) {
        const double dx = static_cast<double>(fluid.position[i].x()) - x;
        const double dy = settings.dimensions == 2 ? 0.0 : static_cast<double>(fluid.position[i].y()) - y;
        if (dx * dx + dy * dy < reach * reach) column.push_back(i);
    }
    return column;
}

/// Particles at the bodies' surfaces, and not with a wall in between. Of a body that none touches, and that is over
/// water, what is under its middle.
std::vector<std::vector<std::uint32_t>> FluidWorld::Impl::particles_at(std::span<const BodyState> at) const
{
    constexpr double kTouching = 2.0; // spacings, from samples, which lie below the surface
    const Scalar reach_sq = static_cast<Scalar>(kTouching * kTouching * spacing() * spacing());
    std::vector<std::vector<std::uint32_t>> touching(bodies.size());
    for (std::uint32_t i = 0; i < fluid.size(); ++i) {
        for (std::uint32_t k = boundary_pairs.start[i]; k < boundary_pairs.start[i + 1]; ++k) {
            const std::uint32_t b = boundary_pairs.index[k];
            const auto owner = static_cast<std::size_t>(boundary.owner[b]);
            if (owner < walls.size() || boundary_pairs.slope[k] == 0) continue;
            std::vector<std::uint32_t>& particles = touching[owner - walls.size()];
            if (!particles.empty() && particles.back() == i) continue;
            const Vec4 way = fluid.position[i] - boundary.position[b];
            if (!(way.head<3>().squaredNorm() < reach_sq)) continue;
            if (wall_parts(fluid.position[i].head<3>().cast<double>(), boundary.position[b].head<3>().cast<double>()))
                continue;
            particles.push_back(i);
        }
    }
    for (std::size_t k = 0; k < at.size(); ++k) {
        const Vec3d& middle = at[k].pose.position;
        if (!touching[k].empty() || !bodies[k].query) continue;
        touching[k] = column_at(middle.x(), middle.y(), 1.0);
        std::erase_if(touching[k],
                      [&](std::uint32_t i) { return static_cast<double>(fluid.position[i].z()) > middle.z(); });
    }
    return touching;
}

/// A vertical line as BodyBasins wants it; nothing under a ceiling, which the water does not choose.
std::optional<SoundingLine> FluidWorld::Impl::line_at(double x, double y, double level) const
{
    const Vec3d surface(x, y, level), up = spacing() * Vec3d::UnitZ();
    if (wall_parts(surface - 0.5 * up, surface + up)) return std::nullopt;
    return SoundingLine{level, column_at(x, y, 0.75)};
}

std::vector<std::optional<double>> FluidWorld::waterlines(std::span<const BodyState> states) const
{
    require(states.size() == impl_->bodies.size(), "the states must be those of all bodies", states.size());
    std::vector<std::optional<double>> found(states.size());
    const std::size_t n = impl_->fluid.size();
    if (n == 0 || states.empty()) return found;
    std::vector<std::vector<std::uint32_t>> touching(states.size());
    if (impl_->has_pairs()) touching = impl_->particles_at(states);
    const auto is_left = [&](std::size_t k) { return !found[k] && !touching[k].empty(); };
    for (const Sounding& sounding : kSoundings) {
        std::vector<std::vector<std::uint32_t>> asked(states.size());
        for (std::size_t k = 0; k < states.size(); ++k)
            if (is_left(k)) asked[k] = touching[k];
        if (std::all_of(asked.begin(), asked.end(), [](const auto& particles) { return particles.empty(); })) break;
        std::vector<SoundingLine> lines;
        impl_->sound(*this, states, sounding.is_fine, sounding.away, sounding.clear,
                     [&](double x, double y, double level) {
                         if (auto line = impl_->line_at(x, y, level)) lines.push_back(std::move(*line));
                     });
        BodyBasins basins(impl_->fluid.position, impl_->fluid_pairs, impl_->spacing(), std::move(asked));
        const std::vector<std::vector<std::size_t>> of_bodies = basins.lines_of_bodies(lines);
        for (std::size_t k = 0; k < states.size(); ++k) {
            if (of_bodies[k].size() < sounding.fewest_levels) continue;
            std::vector<double> levels;
            for (const std::size_t line : of_bodies[k]) levels.push_back(lines[line].level);
            found[k] = median(std::move(levels));
        }
    }
    // In none with a surface of its own, or not known in which: as for all of it.
    const auto is_nowhere = [&](std::size_t k) {
        return impl_->bodies[k].query && !found[k] && (!impl_->has_pairs() || !touching[k].empty());
    };
    std::optional<double> of_all;
    for (std::size_t k = 0; k < states.size(); ++k) {
        if (!is_nowhere(k)) continue;
        if (!of_all) of_all = waterline(states);
        found[k] = of_all;
    }
    return found;
}

} // namespace flotsam
