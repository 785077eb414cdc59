#include "world/wall_guard.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>

namespace flotsam {
namespace {

bool stands(const GuardedMotion& motion)
{
    return motion.twist.linear.isZero(0.0) && motion.twist.angular.isZero(0.0);
}

} // namespace

void WallGuard::build(const std::vector<GuardedSurface>& surfaces, double particle_spacing, const Workers& workers)
{
    surfaces_.clear();
    bounds_.clear();
    reach_.clear();
    for (const GuardedSurface& surface : surfaces) change(surfaces_.size(), surface, particle_spacing, workers);
}

void WallGuard::change(std::size_t k, const GuardedSurface& surface, double particle_spacing, const Workers& workers)
{
    FLOTSAM_ASSERT(k <= surfaces_.size(), "surfaces are numbered without gaps");
    if (k == surfaces_.size()) {
        surfaces_.emplace_back();
        bounds_.emplace_back();
        reach_.emplace_back();
    }
    surfaces_[k] = surface;
    bounds_[k].reset();
    if (surface.query != nullptr) bounds_[k].emplace(*surface.query, particle_spacing, 3.0 * particle_spacing, workers);
    reach_[k] = 0.0;
    if (surface.query != nullptr)
        for (const Vec3d& vertex : surface.query->mesh().vertices) reach_[k] = std::max(reach_[k], vertex.norm());
    clearance_ = 0.02 * particle_spacing;
}

GuardReport WallGuard::stop(std::span<const Vec4> from, std::span<Vec4> to, std::span<Vec4> velocity,
                            std::span<const GuardedMotion> motion, double particle_mass, const Workers& workers,
                            const Response* response, std::span<Wrench> impulses)
{
    FLOTSAM_ASSERT(motion.size() == surfaces_.size() && impulses.size() == surfaces_.size(), "one of each per surface");
    turn_.resize(motion.size());
    for (std::size_t k = 0; k < motion.size(); ++k)
        turn_[k] = motion[k].before.orientation.angularDistance(motion[k].after.orientation);
    chunks_.resize(std::max(chunks_.size(), Workers::chunk_count(from.size())));
    workers.for_chunks(from.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        Stopped& out = chunks_[chunk];
        out.report = {};
        out.stops.clear();
        out.pushes.clear();
        if (out.stops.capacity() == 0) { // few particles of a chunk are stopped at once
            out.stops.reserve(64);
            out.pushes.reserve(64);
        }
        find_near(from.subspan(begin, end - begin), to.subspan(begin, end - begin), motion, out.near);
        for (std::size_t i = begin; i < end; ++i) {
            if (!to[i].allFinite()) continue; // counted by the step as physics in trouble
            if (!may_hit(from[i].head<3>().cast<double>(), to[i].head<3>().cast<double>(), motion, out.near)) continue;
            stop_one(i, from[i], to[i], velocity[i], motion, particle_mass, out);
        }
    });
    const std::size_t chunks = Workers::chunk_count(from.size());
    shares_.assign(motion.size(), 1.0);
    if (response != nullptr) find_shares(chunks, motion, particle_mass, *response, impulses);
    std::fill(impulses.begin(), impulses.end(), Wrench{});
    GuardReport report;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        report.stopped += chunks_[chunk].report.stopped;
        report.leaked += chunks_[chunk].report.leaked;
        give(chunks_[chunk], motion, particle_mass, velocity, impulses);
    }
    return report;
}

/// Sets shares_. A share s of all pushes J at once changes the kinetic energy by s^2 (P + G . Y G) / 2 - s P, with
/// P = sum J^2 / m, and G their sum on an owner of mobility Y: it is least at s = P / (P + G . Y G).
void WallGuard::find_shares(std::size_t chunks, std::span<const GuardedMotion> motion, double particle_mass,
                            const Response& response, std::span<Wrench> whole)
{
    std::fill(whole.begin(), whole.end(), Wrench{});
    lost_.assign(motion.size(), 0.0);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (const Push& push : chunks_[chunk].pushes) {
            const Vec3d arm = push.at - motion[push.surface].before.position;
            whole[push.surface] += {push.impulse, arm.cross(push.impulse)};
            lost_[push.surface] += push.impulse.squaredNorm() / particle_mass;
        }
    }
    if (std::all_of(lost_.begin(), lost_.end(), [](double energy) { return energy == 0.0; })) return;
    changes_.assign(motion.size(), Twist{});
    response(whole, changes_);
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const double gained = whole[k].linear.dot(changes_[k].linear) + whole[k].angular.dot(changes_[k].angular);
        if (lost_[k] > 0.0 && gained > 0.0) shares_[k] = lost_[k] / (lost_[k] + gained);
    }
}

/// Gives the surfaces their shares, and the particles what is left. Momentum is kept, and angular momentum: what
/// putting a particle back takes of it goes to the surface that has it.
void WallGuard::give(const Stopped& chunk, std::span<const GuardedMotion> motion, double particle_mass,
                     std::span<Vec4> velocity, std::span<Wrench> impulses) const
{
    std::size_t next = 0;
    for (const Stop& stop : chunk.stops) {
        Vec3d v = stop.velocity, spin = stop.spin;
        for (; next < stop.pushes; ++next) {
            const Push& push = chunk.pushes[next];
            const double share = shares_[push.surface];
            const Vec3d given = share * push.impulse;
            impulses[push.surface] += {given, (push.at - motion[push.surface].before.position).cross(given)};
            if (share < 1.0) v += (1.0 - share) / particle_mass * push.impulse;
            spin -= push.at.cross(given) / particle_mass;
        }
        velocity[stop.particle].head<3>() = v.cast<Scalar>();
        impulses[stop.keeper] += {Vec3d::Zero(), particle_mass * (spin - stop.position.cross(v))};
    }
}

/// Whether the surface is out of reach by the sphere about its owner's centre that holds it, which no turn changes.
bool WallGuard::passes_far(std::size_t k, const Vec3d& from, const Vec3d& to, const GuardedMotion& motion) const
{
    const Vec3d a = from - motion.before.position, b = to - motion.after.position;
    const double length_a = a.norm();
    // The path's length in the owner's frame is at most this.
    const double length = (b - a).norm() + turn_[k] * length_a;
    return length_a + b.norm() - 2.0 * reach_[k] > length + 2.0 * clearance_;
}

/// The surfaces that passes_far does not rule out for all of a chunk's particles, which are near each other.
void WallGuard::find_near(std::span<const Vec4> from, std::span<const Vec4> to, std::span<const GuardedMotion> motion,
                          std::vector<std::size_t>& near) const
{
    near.clear();
    near.reserve(surfaces_.size());
    Eigen::AlignedBox3d box;
    double way = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        if (!to[i].allFinite()) continue;
        box.extend(Vec3d(from[i].head<3>().cast<double>()));
        way = std::max(way, static_cast<double>((to[i] - from[i]).head<3>().norm()));
    }
    if (box.isEmpty()) return;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
        if (!bounds_[k]) continue;
        const Vec3d &before = motion[k].before.position, &after = motion[k].after.position;
        const double nearest = box.exteriorDistance(before) + std::max(0.0, box.exteriorDistance(after) - way);
        const double farthest = (before - box.center()).norm() + 0.5 * box.diagonal().norm();
        const double length = way + (after - before).norm() + turn_[k] * farthest;
        if (nearest - 2.0 * reach_[k] <= length + 2.0 * clearance_) near.push_back(k);
    }
}

bool WallGuard::may_hit(const Vec3d& from, const Vec3d& to, std::span<const GuardedMotion> motion,
                        std::span<const std::size_t> near) const
{
    for (const std::size_t k : near) {
        if (passes_far(k, from, to, motion[k])) continue;
        const Vec3d a = motion[k].before.to_body(from);
        const Vec3d b = motion[k].after.to_body(to);
        // A path of length L that passes the surface has distance(a) + distance(b) <= L.
        const double length = (b - a).norm() + 2.0 * clearance_;
        if (bounds_[k]->rough_at(a) + bounds_[k]->rough_at(b) > length) continue;
        if (bounds_[k]->at(a) + bounds_[k]->at(b) <= length) return true;
    }
    return false;
}

std::optional<WallGuard::Hit> WallGuard::first_hit(const Vec3d& from, const Vec3d& to,
                                                   std::span<const GuardedMotion> motion) const
{
    std::optional<Hit> first;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
        const GuardedSurface& surface = surfaces_[k];
        if (surface.query == nullptr) continue;
        Vec3d a = motion[k].before.to_body(from);
        const Vec3d b = motion[k].after.to_body(to);
        double start = 0.0;
        // Crossings in the allowed direction (out of a body that has moved over the particle) are passed by.
        for (int tries = 0; tries < 8; ++tries) {
            const auto hit = surface.query->sweep(a, b);
            if (!hit) break;
            const double fraction = start + hit->fraction * (1.0 - start);
            const Vec3d& normal = surface.query->normal(hit->triangle);
            const bool along = (b - a).dot(normal) > 0.0;
            if (along ? surface.stops_along_normals : surface.stops_against_normals) {
                if (!first || fraction < first->fraction) {
                    const Vec3d facing = along ? Vec3d(-normal) : normal;
                    first = Hit{k, fraction, motion[k].after.orientation * facing};
                }
                break;
            }
            const double length = (b - a).norm();
            const double next = hit->fraction + 1e-9 + 1e-7 * clearance_ / std::max(length, 1e-300);
            if (next >= 1.0) break;
            start = start + next * (1.0 - start);
            a += next * (b - a);
        }
    }
    return first;
}

void WallGuard::stop_one(std::size_t i, const Vec4& from, Vec4& to, const Vec4& velocity,
                         std::span<const GuardedMotion> motion, double particle_mass, Stopped& out) const
{
    constexpr int kMaxBounces = 4; // a corner of three walls takes three
    const Vec3d a = from.head<3>().cast<double>();
    Vec3d b = to.head<3>().cast<double>();
    Vec3d v = velocity.head<3>().cast<double>();
    std::optional<std::size_t> stopped_by;
    const Vec3d spin = b.cross(v);
    for (int bounce = 0; bounce <= kMaxBounces; ++bounce) {
        const auto hit = first_hit(a, b, motion);
        if (!hit) break;
        stopped_by = hit->surface;
        const GuardedMotion& solid = motion[hit->surface];
        const Vec3d at = a + hit->fraction * (b - a);
        const Vec3d wall_velocity = solid.twist.at(at - solid.before.position);
        const double approach = (v - wall_velocity).dot(hit->normal);
        if (approach < 0.0) {
            v -= approach * hit->normal;
            out.pushes.push_back({hit->surface, at, particle_mass * approach * hit->normal});
        }
        // Slide along the surface: what is beyond it of the way is taken off, and a little more.
        const double beyond = (b - at).dot(hit->normal);
        b += (clearance_ - beyond) * hit->normal;
        if (bounce == kMaxBounces) {
            // No way found in a narrow place: go with the surface from where the particle was. Of a wall and a body
            // that closes on it, stay in front of the wall: a particle in the skin of the body is not lost.
            const auto go_with = [&](std::size_t k) { return motion[k].after.to_world(motion[k].before.to_body(a)); };
            const auto other = first_hit(a, go_with(hit->surface), motion);
            if (other && stands(motion[other->surface])) stopped_by = other->surface;
            const GuardedMotion& keeper = motion[*stopped_by];
            b = go_with(*stopped_by);
            const Vec3d keeper_velocity = keeper.twist.at(at - keeper.before.position);
            out.pushes.push_back({*stopped_by, at, particle_mass * (v - keeper_velocity)});
            v = keeper_velocity;
            if (other && !stands(keeper)) ++out.report.leaked;
        }
    }
    if (!stopped_by) return;
    ++out.report.stopped;
    to.head<3>() = b.cast<Scalar>();
    out.stops.push_back({i, *stopped_by, b, v, spin, out.pushes.size()});
}

} // namespace flotsam
