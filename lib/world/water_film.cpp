#include "world/water_film.hpp"

#include "core/smooth_step.hpp"
#include "world/usable_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace flotsam {
namespace {

// Lengths in spacings.
constexpr double kPiece = 0.7;                 ///< longest edge of a part of a face
constexpr double kOverlap = 0.2;               ///< that solids may have in each other: a contact that yields
constexpr double kNarrow = 0.9, kWide = 1.3;   ///< gaps are films whole, and not at all
constexpr double kTaken = 0.75, kFree = 1.15;  ///< distance to the nearest particle at which it has the place, or not
constexpr double kTight = 0.02, kLoose = 0.15; ///< gaps in a wedge on which its particles do not press, and do
constexpr double kReach = 1.2;                 ///< of a part's neighbours in a film
constexpr double kAtRim = 1.6, kWeights = 2.0; ///< of a rim's particles: that it is wet, that they count

constexpr double kMostOfStill = 1.5;         ///< of the pressure under the highest particle that a film may have
constexpr double kStep = 0.08, kWedge = 0.2; ///< slopes of a rim at which it is a step, and a wedge

/// Parts of the faces of a closed mesh, none for an open one; in 2-D of its outline, with lengths for areas.
std::vector<TrianglePiece> faces_of(const TriangleMesh& mesh, double spacing, int dimensions)
{
    if (!is_closed(mesh)) return {};
    const double longest = kPiece * spacing;
    if (dimensions != 2) return pieces_of(mesh, longest);
    TriangleMesh thin = mesh;
    const double scale = 0.5 * longest / bounds(mesh).size().y();
    for (Vec3d& vertex : thin.vertices) vertex.y() *= scale;
    std::vector<TrianglePiece> pieces = pieces_of(thin, longest);
    std::erase_if(pieces, [](const TrianglePiece& piece) { return std::abs(piece.normal.y()) > 0.5; });
    for (TrianglePiece& piece : pieces) {
        piece.center.y() = 0.0;
        piece.area /= 0.5 * longest;
    }
    return pieces;
}

/// Whether a surface that was met in front of a face looks at it.
bool looks_back(const Vec3d& normal, const Vec3d& face_normal, WallSide side)
{
    const double along = normal.dot(face_normal);
    if (side == WallSide::inside) return along > 0.5;
    if (side == WallSide::outside) return along < -0.5;
    return std::abs(along) > 0.5;
}

} // namespace

void WaterFilms::forget(std::size_t owner)
{
    if (owner < faces_.size()) faces_[owner] = {};
}

void WaterFilms::fill(const WaterFilmSettings& settings, double dt, const FilmWater& water,
                      std::span<const FilmSolid> solids, const WallGuard& guard)
{
    settings_ = settings;
    ++step_;
    films_.clear();
    pressed_.clear();
    faces_.resize(solids.size());
    if (std::none_of(solids.begin(), solids.end(), [](const FilmSolid& solid) { return solid.responds; })) return;
    find_touches(water, solids);
    bool has_top = false;
    for (std::size_t begin = 0, end = 0; begin < touches_.size(); begin = end) {
        const Touch pair = touches_[begin]; // a copy: find_facing may make room
        while (end < touches_.size() && touches_[end].a == pair.a && touches_[end].b == pair.b) ++end;
        find_facing(pair.a, pair.b, solids, guard);
        if (facing_.empty()) continue;
        if (!has_top) find_top(water.fluid);
        has_top = true;
        const std::span<const Touch> touches(touches_.data() + begin, end - begin);
        leave_to_particles(touches, water.fluid);
        join_and_find_rims();
        for (std::size_t first = 0, last = 0; first < facing_.size(); first = last) {
            while (last < facing_.size() && facing_[last].set == facing_[first].set) ++last;
            const std::span<const Facing> parts(facing_.data() + first, last - first);
            const Rim rim = weigh_rim(parts, touches.size());
            if (!(rim.wet + rim.wedge > 0.0)) continue;
            Around around = pressure_around(touches, water);
            around.pressure -= inflow_head(parts, rim, solids[pair.a], solids[pair.b]);
            press(parts, rim, around, dt, pair.a, pair.b, solids);
        }
    }
}

/// Sets top_: of the highest water, along gravity.
void WaterFilms::find_top(const FluidState& fluid)
{
    const Vec3 down = settings_.gravity.cast<Scalar>();
    Scalar top = std::numeric_limits<Scalar>::infinity();
    for (const Vec4& position : fluid.position) top = std::min(top, down.dot(position.head<3>()));
    top_ = static_cast<double>(top);
}

/// Pairs of solids that touch the same particle, at least one of which responds: that is `a`, the first one of two.
void WaterFilms::find_touches(const FilmWater& water, std::span<const FilmSolid> solids)
{
    const Contacts& contacts = water.contacts;
    const Pairs& pairs = water.boundary_pairs;
    touches_.clear();
    owners_at_.resize(pairs.rows());
    std::fill(owners_at_.begin(), owners_at_.end(), std::uint8_t(0));
    for (const std::uint32_t i : contacts.particle) owners_at_[i] = owners_at_[i] == 0 ? 1 : 2;
    for (std::uint32_t a = 0; a < solids.size(); ++a) {
        if (!solids[a].responds || solids[a].query == nullptr) continue;
        for (std::uint32_t k = contacts.start[a]; k < contacts.start[a + 1]; ++k) {
            const std::uint32_t i = contacts.particle[k];
            if (owners_at_[i] < 2 || water.is_pinched[i] != 0) continue;
            const std::size_t first = touches_.size();
            for (std::uint32_t p = pairs.start[i]; p < pairs.start[i + 1]; ++p) {
                const auto b = static_cast<std::uint32_t>(water.sample_owner[pairs.index[p]]);
                if (b == a || solids[b].query == nullptr || (solids[b].responds && b < a)) continue;
                const auto is_it = [&](const Touch& touch) { return touch.b == b; };
                if (std::none_of(touches_.begin() + static_cast<std::ptrdiff_t>(first), touches_.end(), is_it))
                    touches_.push_back({a, b, i});
            }
        }
    }
    std::sort(touches_.begin(), touches_.end());
}

/// When a body first comes near another solid. Later steps shall find room enough.
void WaterFilms::cut(Faces& faces, const TriangleMesh& mesh)
{
    constexpr std::size_t kMostAtOnce = 20000; // of the parts of a large body that face another one
    faces.is_cut = true;
    faces.parts = faces_of(mesh, settings_.spacing, settings_.dimensions);
    faces.pressure.assign(faces.parts.size(), 0.0);
    faces.last_steps.assign(faces.parts.size(), 0);
    const std::size_t most = std::min(faces.parts.size(), kMostAtOnce);
    touches_.reserve(most);
    facing_.reserve(most);
    points_.reserve(most);
    particles_.reserve(most);
    parts_.reserve(most);
    sets_.reserve(most);
    weight_.reserve(most);
    films_.reserve(faces_.size());
    pressed_.reserve(most);
}

/// Sets facing_: the parts of a's faces that b is in front of.
void WaterFilms::find_facing(std::size_t a, std::size_t b, std::span<const FilmSolid> solids, const WallGuard& guard)
{
    facing_.clear();
    Faces& faces = faces_[a];
    if (!faces.is_cut) cut(faces, solids[a].query->mesh());
    const double overlap = kOverlap * settings_.spacing, wide = kWide * settings_.spacing;
    const Pose& pose = solids[a].pose;
    const SurfaceQuery& other = *solids[b].query;
    const Quatd turn = solids[b].pose.orientation.conjugate() * pose.orientation;
    const Vec3d shift = solids[b].pose.to_body(pose.position);
    const Aabb near = other.bounds().inflated(wide);
    for (std::size_t q = 0; q < faces.parts.size(); ++q) {
        const TrianglePiece& part = faces.parts[q];
        const Vec3d at = shift + turn * part.center; // in b's frame
        if (!near.contains(at) || guard.distance_bound(b, at) > wide) continue;
        const Vec3d normal = turn * part.normal;
        const auto hit = other.sweep(at - overlap * normal, at + wide * normal);
        if (!hit) continue;
        const Vec3d& met = other.normal(hit->triangle);
        if (!looks_back(met, normal, solids[b].side)) continue;
        const double gap = std::max(0.0, hit->fraction * (overlap + wide) - overlap);
        Facing facing;
        facing.center = pose.to_world(part.center);
        facing.normal = pose.orientation * part.normal;
        facing.middle = facing.center + 0.5 * gap * facing.normal;
        facing.area = part.area;
        facing.gap = gap;
        facing.slope = met.cross(normal).norm();
        facing.share = 1.0 - smooth_step((gap / settings_.spacing - kNarrow) / (kWide - kNarrow));
        facing.part = static_cast<std::uint32_t>(q);
        facing_.push_back(facing);
    }
}

/// Where particles have got into the gap, the pressure is theirs.
void WaterFilms::leave_to_particles(std::span<const Touch> touches, const FluidState& fluid)
{
    const double spacing = settings_.spacing;
    points_.clear();
    for (const Touch& touch : touches) points_.push_back(fluid.position[touch.particle].head<3>().cast<double>());
    particles_.build(points_, kWeights * spacing);
    for (Facing& facing : facing_) {
        const double away = particles_.nearest(facing.middle, kFree * spacing) / spacing;
        facing.share *= smooth_step((away - kTaken) / (kFree - kTaken));
    }
    std::erase_if(facing_, [](const Facing& facing) { return facing.share < 0.01; });
}

/// Sorts facing_ by the films that its parts belong to, and finds which of them are at their rims.
void WaterFilms::join_and_find_rims()
{
    constexpr double kCovered = 0.75; // of what is around a part within a film; on a straight rim it is a half
    const double reach = kReach * settings_.spacing;
    const double around = settings_.dimensions == 2 ? 2.0 * reach : std::numbers::pi * reach * reach;
    points_.clear();
    for (const Facing& facing : facing_) points_.push_back(facing.center);
    parts_.build(points_, reach);
    sets_.reset(facing_.size());
    for (std::size_t q = 0; q < facing_.size(); ++q) {
        double covered = 0.0;
        parts_.for_near(facing_[q].center, reach, [&](std::size_t other, double) {
            covered += facing_[other].share * facing_[other].area;
            sets_.join(q, other);
        });
        facing_[q].is_rim = covered < kCovered * around;
    }
    for (std::size_t q = 0; q < facing_.size(); ++q) facing_[q].set = sets_.find(q);
    std::sort(facing_.begin(), facing_.end(),
              [](const Facing& x, const Facing& y) { return x.set != y.set ? x.set < y.set : x.part < y.part; });
}

/// Sets weight_, how much of the rim of a film each of the pair's touches stands at.
WaterFilms::Rim WaterFilms::weigh_rim(std::span<const Facing> parts, std::size_t particles)
{
    const double spacing = settings_.spacing, reach = kWeights * spacing;
    weight_.resize(particles);
    std::fill(weight_.begin(), weight_.end(), 0.0);
    double wet = 0.0, wedge = 0.0, rim = 0.0;
    for (const Facing& part : parts) {
        if (!part.is_rim) continue;
        const double area = part.share * part.area;
        rim += area;
        if (!(particles_.nearest(part.middle, kAtRim * spacing) < kAtRim * spacing)) continue;
        const double step = 1.0 - smooth_step((part.slope - kStep) / (kWedge - kStep));
        wet += step * area;
        wedge += (1.0 - step) * area;
        particles_.for_near(part.middle, reach, [&](std::size_t k, double distance_sq) {
            weight_[k] += area * std::pow(1.0 - distance_sq / (reach * reach), 2);
        });
    }
    if (!(rim > 0.0)) return {};
    const double width = (settings_.dimensions == 2 ? 0.5 : 0.4) * kReach * spacing; // of the parts that count as rim
    return {wet / rim, wedge / rim, (wet + wedge) / width};
}

/// Particles in the corner of two solids carry about twice the pressure of the water, and one at a wall half as much
/// again: they bear all of what presses on the faces there. So the ones near them are asked that touch nothing; where
/// water is too shallow for that, those in the corner.
WaterFilms::Around WaterFilms::pressure_around(std::span<const Touch> touches, const FilmWater& water) const
{
    constexpr double kInCorner = 0.5;
    const FluidState& fluid = water.fluid;
    const auto for_free_neighbours = [&](std::uint32_t i, const auto& visit) {
        for (std::uint32_t p = water.fluid_pairs.start[i]; p < water.fluid_pairs.start[i + 1]; ++p) {
            const std::uint32_t j = water.fluid_pairs.neighbour(i, p);
            if (water.boundary_pairs.start[j] == water.boundary_pairs.start[j + 1]) visit(j);
        }
    };
    Around free, corner;
    double free_weights = 0.0, corner_weights = 0.0;
    for (std::size_t k = 0; k < touches.size(); ++k) {
        const double weight = weight_[k];
        if (!(weight > 0.0)) continue;
        const auto take = [&](std::uint32_t j) {
            free.pressure += weight * static_cast<double>(fluid.pressure[j]);
            free.place += weight * fluid.position[j].head<3>().cast<double>();
            free_weights += weight;
        };
        // Layers next to a wall lie in turn above and below the mean: those around the nearest count, too.
        const std::uint32_t i = touches[k].particle;
        for_free_neighbours(i, [&](std::uint32_t j) {
            take(j);
            for_free_neighbours(j, take);
        });
        corner.pressure += kInCorner * weight * static_cast<double>(fluid.pressure[i]);
        corner.place += weight * fluid.position[i].head<3>().cast<double>();
        corner_weights += weight;
    }
    const bool is_free = free_weights > 0.0;
    const Around& sum = is_free ? free : corner;
    const double weights = is_free ? free_weights : corner_weights;
    return {sum.pressure / weights, sum.place / weights};
}

/// What water that flows in at the rim, to fill a gap that opens, has less of pressure: Bernoulli's rho0 u^2 / 2 [Pa].
double WaterFilms::inflow_head(std::span<const Facing> parts, const Rim& rim, const FilmSolid& a,
                               const FilmSolid& b) const
{
    double opens = 0.0, volume = 0.0, area = 0.0;
    for (const Facing& part : parts) {
        const Vec3d parting = a.twist.at(part.center - a.pose.position) - b.twist.at(part.center - b.pose.position);
        const double here = part.share * part.area;
        opens -= here * parting.dot(part.normal);
        volume += here * part.gap;
        area += here;
    }
    const double gap = std::max(volume / area, 0.5 * settings_.spacing);
    const double speed = std::max(0.0, opens / (rim.length * gap));
    return 0.5 * settings_.rest_density * speed * speed;
}

void WaterFilms::press(std::span<const Facing> parts, const Rim& rim, const Around& around, double dt, std::size_t a,
                       std::size_t b, std::span<const FilmSolid> solids)
{
    Faces& faces = faces_[a];
    const double follow = std::min(1.0, dt / settings_.delay);
    Film film{a, b, 1.0, {}, {}, pressed_.size(), 0};
    for (const Facing& part : parts) {
        const double head = settings_.rest_density * settings_.gravity.dot(part.center - around.place);
        const double depth = settings_.gravity.dot(part.center) - top_;
        const double most = kMostOfStill * settings_.rest_density * std::max(0.0, depth);
        const double apex = 1.0 - smooth_step((part.gap / settings_.spacing - kTight) / (kLoose - kTight));
        const double target = (rim.wet + rim.wedge * apex) * std::clamp(around.pressure + head, 0.0, most);
        double& pressure = faces.pressure[part.part];
        if (step_ - faces.last_steps[part.part] > 1) pressure = 0.0;
        faces.last_steps[part.part] = step_;
        pressure += follow * (target - pressure);
        const double force = pressure * part.share * part.area;
        const Wrench push{-force * part.normal, Vec3d::Zero()};
        film.on_a += push.seen_at(part.center - solids[a].pose.position);
        film.on_b += push.seen_at(part.center - solids[b].pose.position) * -1.0;
        pressed_.push_back({faces.parts[part.part].triangle, force});
    }
    film.last_part = pressed_.size();
    films_.push_back(film);
}

void WaterFilms::limit(std::span<const double> share)
{
    for (Film& film : films_) film.share = std::min(share[film.a], share[film.b]);
}

void WaterFilms::add_impulses(double dt, std::span<Wrench> impulses) const
{
    for (const Film& film : films_) {
        impulses[film.a] += film.on_a * (dt * film.share);
        impulses[film.b] += film.on_b * (dt * film.share);
    }
}

void WaterFilms::add_to_triangles(std::size_t owner, std::span<double> force) const
{
    for (const Film& film : films_) {
        if (film.a != owner) continue;
        for (std::size_t q = film.first_part; q < film.last_part; ++q)
            force[pressed_[q].triangle] += film.share * pressed_[q].force;
    }
}

} // namespace flotsam
