#include "world/fluid_world_impl.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "world/usable_mesh.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <sstream>

namespace flotsam {
namespace {

constexpr int kRoundsAtStart = 60; ///< at most, at the start

/// Inside the closed sides of a box wall: open ones do not bound.
bool inside_box_wall(const Wall& wall, const Vec3d& p, int dimensions)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (dimensions == 2 && axis == 1) continue;
        const std::size_t low = 2 * static_cast<std::size_t>(axis);
        if (!wall.open[low] && !(p[axis] >= wall.box->min[axis])) return false;
        if (!wall.open[low + 1] && !(p[axis] <= wall.box->max[axis])) return false;
    }
    return true;
}

/// Whether the point is in a tank: in one box wall and in all that are not tanks of their own beside it.
bool inside_box_walls(const std::vector<Wall>& walls, const Vec3d& p, int dimensions)
{
    const auto holds = [&](const Wall& tank) {
        return std::all_of(walls.begin(), walls.end(), [&](const Wall& wall) {
            return !wall.box || inside_box_wall(wall, p, dimensions) ||
                   (&wall != &tank && parted_by(*tank.box, tank.open, *wall.box, wall.open, dimensions));
        });
    };
    bool is_any = false;
    for (const Wall& wall : walls) {
        if (!wall.box) continue;
        if (holds(wall)) return true;
        is_any = true;
    }
    return !is_any;
}

/// What a wall holds that is closed on all sides [m^3; in 2-D m^2]; nothing for others, and for meshes in 2-D.
std::optional<double> volume_within(const Wall& wall, int dimensions)
{
    if (!wall.box) {
        if (dimensions == 2 || wall.side != WallSide::inside || !is_closed(wall.mesh)) return std::nullopt;
        return mass_properties(wall.mesh).volume;
    }
    double volume = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        if (dimensions == 2 && axis == 1) continue;
        const std::size_t low = 2 * static_cast<std::size_t>(axis);
        if (wall.open[low] || wall.open[low + 1]) return std::nullopt;
        volume *= wall.box->size()[axis];
    }
    return volume;
}

Aabb extent_of(const std::vector<Vec3d>& points)
{
    Aabb box;
    for (const Vec3d& point : points) box.extend(point);
    return box;
}

/// Whether particles in `water` are all around a body, and under it or beside its lowest point.
bool surrounds(const Aabb& water, const Aabb& body, int dimensions)
{
    const bool along_x = water.min.x() < body.min.x() && water.max.x() > body.max.x();
    const bool along_y = dimensions == 2 || (water.min.y() < body.min.y() && water.max.y() > body.max.y());
    return along_x && along_y && water.min.z() < body.max.z();
}

} // namespace

void FluidWorld::Impl::prepare(Bodies& port, const std::function<void(const SettleProgress&)>& on_round)
{
    if (is_settled) return;
    read_bodies(settings.max_time_step, port);
    for (const BodyState& state : states)
        max_speed = std::max({max_speed, state.start.linear.norm(), state.predicted.linear.norm()});
    if (prepared) { // the settling was broken off
        StepReport ignored;
        take_in_changes(ignored);
    } else {
        choose_wall_sides();
        prepared = true; // what is refused has been by now
        place_water();
    }
    if (settings.start == FluidWorldSettings::Start::at_rest) settle(on_round);
    is_settled = true;
}

void FluidWorld::Impl::place_water()
{
    cut_and_place_fluid();
    find_deepest_catch();
    sample_surfaces();
    std::vector<GuardedSurface> surfaces;
    for (const Wall& wall : walls) {
        surfaces.push_back({wall.query.get(), wall.side != WallSide::outside, wall.side != WallSide::inside});
    }
    for (const BodySurface& body : bodies) surfaces.push_back({body.query.get(), false, true});
    guard.build(surfaces, spacing(), workers);
    place_body_samples();
    relax(kRoundsAtStart);
    loosen_enclosed_water();
    for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].last_pose = states[k].pose;
}

/// How often a wall winds around the water that is given, in the mean: 1 where it holds all of it, -1 where it does and
/// faces the wrong way.
double FluidWorld::Impl::mean_winding(const Wall& wall) const
{
    double sum = 0.0;
    std::size_t count = 0;
    for (const FluidSeed& seed : seeds) {
        const std::size_t stride = 1 + seed.positions.size() / 2000;
        for (std::size_t k = 0; k < seed.positions.size(); k += stride, ++count)
            sum += wall.query->winding_number(seed.positions[k]);
    }
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/// A wall that has most of the water inside is a container. Where none has, and no other wall holds water, the closed
/// one is that has the largest part of it inside, if that is as much as a quarter: the water is cut by its container,
/// not by some ground that it lies on.
void FluidWorld::Impl::choose_wall_sides()
{
    constexpr double kLeast = 0.25;
    const auto turn = [](Wall& wall) {
        wall.mesh = flipped(std::move(wall.mesh));
        wall.query = std::make_unique<SurfaceQuery>(wall.mesh);
    };
    std::vector<double> inside(walls.size(), 0.0); // of the water, of those that may be containers after all
    bool is_held = false;
    for (std::size_t k = 0; k < walls.size(); ++k) {
        Wall& wall = walls[k];
        wall.query = std::make_unique<SurfaceQuery>(wall.mesh);
        if (wall.side == WallSide::automatic) {
            const double mean = mean_winding(wall);
            if (mean < -0.5) turn(wall);
            const bool container = std::abs(mean) > 0.5;
            wall.side = container ? WallSide::inside : is_closed(wall.mesh) ? WallSide::outside : WallSide::both;
            inside[k] = wall.side == WallSide::outside ? mean : 0.0;
        }
        is_held = is_held || wall.side != WallSide::outside;
    }
    const auto largest =
        std::max_element(inside.begin(), inside.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (!is_held && largest != inside.end() && std::abs(*largest) > kLeast) {
        Wall& wall = walls[static_cast<std::size_t>(largest - inside.begin())];
        if (*largest < 0.0) turn(wall);
        wall.side = WallSide::inside;
        notes.push_back(wall.name + " is taken for the container of the water, of which a part is inside; its side can "
                                    "be given");
    }
    for (BodySurface& body : bodies)
        if (!body.mesh.empty()) body.query = std::make_unique<SurfaceQuery>(body.mesh);
}

bool FluidWorld::Impl::in_solid(const Vec3d& point) const
{
    if (!inside_box_walls(walls, point, settings.dimensions)) return true;
    for (const Wall& wall : walls) {
        if (wall.box || wall.side == WallSide::both) continue;
        if (wall.query->inside(point) == (wall.side == WallSide::outside)) return true;
    }
    for (std::size_t k = 0; k < bodies.size(); ++k)
        if (in_body(k, states[k].pose, point)) return true;
    return false;
}

bool FluidWorld::Impl::in_body(std::size_t k, const Pose& pose, const Vec3d& point) const
{
    if (!bodies[k].query) return false; // removed
    const Vec3d local = pose.to_body(point);
    const SurfaceQuery& query = *bodies[k].query;
    if (!query.bounds().inflated(1e-3 * spacing()).contains(local)) return false;
    // Where a lattice lies in the faces, every other particle of it stays: rounding must not decide about whole layers,
    // on one side of a body this way and on the other that.
    const double distance = query.signed_distance(local);
    if (std::abs(distance) > 1e-3 * spacing()) return distance < 0.0;
    const Vec3d cell = point / spacing();
    return std::fmod(std::abs(std::floor(cell.x()) + std::floor(cell.y()) + std::floor(cell.z())), 2.0) > 0.5;
}

/// Water around a vessel does not fill her: takes what lies in her basins out of `keep`.
void FluidWorld::Impl::bail_out(const FluidSeed& seed, const std::vector<Vessel>& vessels, std::vector<char>& keep)
{
    const Aabb water = extent_of(seed.positions);
    for (const Vessel& vessel : vessels) {
        if (!surrounds(water, vessel.bounds, settings.dimensions)) continue;
        std::atomic<std::size_t> count = 0;
        workers.for_each(keep.size(), [&](std::size_t k) {
            if (keep[k] == 0 || !vessel.basins.holds(seed.positions[k], 0.01 * spacing())) return;
            keep[k] = 0;
            count.fetch_add(1, std::memory_order_relaxed);
        });
        if (count == 0) continue;
        std::ostringstream note;
        note << bodies[vessel.body].name << " starts dry: " << count << " fluid particles in it were left out";
        notes.push_back(note.str());
    }
}

/// Water that was poured twice into one place would burst out of it: takes out of `keep` what lies in an earlier block
/// or mesh of water, unless that is bailed out there.
void FluidWorld::Impl::leave_out_doubles(std::size_t seed, const std::vector<Vessel>& vessels, std::vector<char>& keep)
{
    std::vector<const Vessel*> bailed; // out of the earlier water
    const auto is_dry = [&](const Vec3d& point) {
        return std::any_of(bailed.begin(), bailed.end(),
                           [&](const Vessel* vessel) { return vessel->basins.holds(point, 0.01 * spacing()); });
    };
    std::size_t doubles = 0;
    for (std::size_t k = 0; k < seed; ++k) {
        if (!seeds[k].covers) continue;
        bailed.clear();
        for (const Vessel& vessel : vessels)
            if (seeds[k].cut && surrounds(extent_of(seeds[k].positions), vessel.bounds, settings.dimensions))
                bailed.push_back(&vessel);
        const std::vector<Vec3d>& points = seeds[seed].positions;
        for (std::size_t i = 0; i < keep.size(); ++i) {
            if (keep[i] == 0 || !seeds[k].covers(points[i]) || is_dry(points[i])) continue;
            keep[i] = 0;
            ++doubles;
        }
    }
    if (doubles > 0)
        notes.push_back(std::to_string(doubles) + " fluid particles lay in an earlier block or mesh of fluid too and "
                                                  "were left out");
}

/// Bodies with basins whose rims are above the water around them.
std::vector<Vessel> FluidWorld::Impl::find_vessels() const
{
    std::vector<Vessel> vessels;
    if (!is_level(settings.gravity)) return vessels;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        if (!bodies[k].query) continue; // removed
        const TriangleMesh hull = hull_of(bodies[k].mesh, settings.dimensions);
        const Aabb extent = bounds(transformed(hull, states[k].pose));
        double level = -std::numeric_limits<double>::infinity();
        for (const FluidSeed& seed : seeds) {
            const Aabb water = extent_of(seed.positions);
            if (seed.cut && surrounds(water, extent, settings.dimensions))
                level = std::max(level, water.max.z() + 0.5 * spacing());
        }
        if (!(level > extent.min.z())) continue;
        Vessel vessel{k, extent, BasinQuery(hull, states[k].pose, level)};
        if (!vessel.basins.empty()) vessels.push_back(std::move(vessel));
    }
    return vessels;
}

void FluidWorld::Impl::cut_and_place_fluid()
{
    std::size_t cut_away = 0;
    std::vector<char> keep;
    const std::vector<Vessel> vessels = find_vessels();
    for (std::size_t number = 0; number < seeds.size(); ++number) {
        const FluidSeed& seed = seeds[number];
        keep.assign(seed.positions.size(), 1);
        if (seed.cut) {
            workers.for_each(keep.size(), [&](std::size_t k) { keep[k] = in_solid(seed.positions[k]) ? 0 : 1; });
            cut_away += static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 0));
            leave_out_doubles(number, vessels, keep);
            bail_out(seed, vessels, keep);
        }
        const Vec4 velocity(static_cast<Scalar>(seed.velocity.x()), static_cast<Scalar>(seed.velocity.y()),
                            static_cast<Scalar>(seed.velocity.z()), Scalar(0));
        for (std::size_t k = 0; k < keep.size(); ++k) {
            if (keep[k] == 0) continue;
            Vec4 position = Vec4::Zero();
            position.head<3>() = seed.positions[k].cast<Scalar>();
            fluid.position.push_back(position);
            fluid.velocity.push_back(velocity);
            placed.push_back(seed.cut ? 0 : 1);
        }
        max_speed = std::max(max_speed, seed.velocity.norm());
    }
    const std::size_t n = fluid.position.size();
    fluid.particle_mass = settings.rest_density * std::pow(spacing(), settings.dimensions);
    fluid.density.assign(n, static_cast<Scalar>(settings.rest_density));
    fluid.pressure.assign(n, Scalar(0));
    fluid.id.resize(n);
    for (std::size_t i = 0; i < n; ++i) fluid.id[i] = static_cast<std::uint32_t>(i);
    if (cut_away > 0) {
        std::ostringstream note;
        note << cut_away << " of " << n + cut_away << " fluid particles lay inside walls or bodies and were cut away";
        notes.push_back(note.str());
    }
    double low = 0.0, high = 0.0; // along gravity, for the first step's pressure
    for (const Vec4& p : fluid.position) {
        const Vec3 away = (p - fluid.position[0]).head<3>();
        const double depth = settings.gravity.dot(away.cast<double>());
        low = std::min(low, depth);
        high = std::max(high, depth);
    }
    max_pressure = settings.rest_density * (high - low);
    seeds.clear();
    seeds.shrink_to_fit();
}

/// Neighbours and densities of the particles as they lie. (A step does the same under its stages' clocks.)
void FluidWorld::Impl::look_around(StepReport& report)
{
    sample_walls_in_reach();
    find_neighbours();
    measure_density(report);
}

/// The lattice of the start is a little too dense where it was cut or stretched: shift it to rest density before any
/// velocity can come of it.
void FluidWorld::Impl::relax(int max_rounds)
{
    StepReport ignored;
    for (int round = 0; round < max_rounds && fluid.size() > 0; ++round) {
        look_around(ignored);
        if (ignored.compression_mean <= 0.5 * settings.pressure.tolerance && ignored.compression_max < 0.01) break;
        if (solve_shift(pressure_system()).iterations == 0) break;
        new_position.resize(fluid.size());
        workers.for_each(fluid.size(), [&](std::size_t i) {
            new_position[i] = fluid.position[i];
            if (placed[fluid.id[i]] == 0) new_position[i] += shift[i];
        });
        guard_relaxation();
        fluid.position.swap(new_position);
    }
}

/// Room for water in the one wall that is closed on all sides, less the bodies [m^3; in 2-D m^2]; infinite without one.
double FluidWorld::Impl::enclosed_room() const
{
    const bool is_plane = settings.dimensions == 2;
    constexpr double kOpen = std::numeric_limits<double>::infinity();
    double room = kOpen;
    for (const Wall& wall : walls) {
        const std::optional<double> volume = volume_within(wall, settings.dimensions);
        if (!volume) continue;
        if (room < kOpen) return kOpen; // which of two holds the water is not known
        room = *volume;
    }
    if (!(room < kOpen)) return kOpen;
    for (const BodySurface& body : bodies) {
        if (!body.query) continue;
        const double volume = mass_properties(body.mesh).volume;
        room -= is_plane ? volume / body.query->bounds().size().y() : volume;
    }
    return room;
}

/// Whether solids enclose more water than has room: the density stays too high, or so even that nothing gives way, and
/// there is no free surface, where some particles would have less than the rest density.
bool FluidWorld::Impl::is_overfull()
{
    if (fluid.size() == 0) return false;
    StepReport measured;
    look_around(measured);
    const auto part_below = [&](double share) {
        const Scalar limit = static_cast<Scalar>(share * settings.rest_density);
        const auto count =
            std::count_if(fluid.density.begin(), fluid.density.end(), [&](Scalar d) { return d < limit; });
        return static_cast<double>(count) / static_cast<double>(fluid.size());
    };
    if (measured.compression_mean > 2.0 * settings.pressure.tolerance) return part_below(0.97) < 0.01;
    return part_below(0.97) < 0.001 && part_below(0.99) < 0.01;
}

/// A lattice that fills a closed tank to the last particle is too dense by a few thousandths, which no pressure takes
/// out of it: pressure would grow without bound. Particles are taken away at the top until the rest has room.
void FluidWorld::Impl::loosen_enclosed_water()
{
    constexpr double kFull = 0.97, kMost = 0.05; // parts of the room, and of the particles that may be taken away
    constexpr std::size_t kParts = 400;          // one of so many at a time
    const std::size_t all = fluid.size();
    const double least = (1.0 - kMost) * static_cast<double>(all);
    if (static_cast<double>(all) * std::pow(spacing(), settings.dimensions) < kFull * enclosed_room()) return;
    const Vec3d up = settings.gravity.norm() > 0.0 ? Vec3d(-settings.gravity.normalized()) : Vec3d::UnitZ();
    const auto height = [&](std::uint32_t i) { return up.dot(fluid.position[i].head<3>().cast<double>()); };
    std::vector<std::uint32_t> highest;
    while (static_cast<double>(fluid.size()) > least && is_overfull()) {
        highest.clear();
        for (std::uint32_t i = 0; i < fluid.size(); ++i)
            if (placed[fluid.id[i]] == 0) highest.push_back(i);
        const std::size_t count = std::min(highest.size(), 1 + fluid.size() / kParts);
        if (count == 0) break; // the caller wants all where they are
        std::partial_sort(highest.begin(), highest.begin() + static_cast<std::ptrdiff_t>(count), highest.end(),
                          [&](std::uint32_t a, std::uint32_t b) { return height(a) > height(b); });
        highest.resize(count);
        std::sort(highest.begin(), highest.end());
        StepReport ignored;
        remove_particles(highest, ignored);
        relax(kRoundsAtStart);
    }
    if (fluid.size() == all) return;
    std::ostringstream note;
    note << all - fluid.size() << " of " << all
         << " fluid particles found no room between walls and bodies that enclose"
         << " the water, and were taken away at the top";
    notes.push_back(note.str());
}

void FluidWorld::Impl::guard_relaxation()
{
    new_velocity.assign(fluid.size(), Vec4::Zero());
    motion.resize(owners());
    guarded.assign(owners(), Wrench{});
    for (std::size_t k = 0; k < bodies.size(); ++k) motion[walls.size() + k] = {states[k].pose, states[k].pose, {}};
    guard.stop(fluid.position, new_position, new_velocity, motion, fluid.particle_mass, workers, nullptr, guarded);
}

} // namespace flotsam
