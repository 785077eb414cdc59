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
                            std::span<Wrench> impulses)
{
    FLOTSAM_ASSERT(motion.size() == surfaces_.size() && impulses.size() == surfaces_.size(), "one of each per surface");
    turn_.resize(motion.size());
    for (std::size_t k = 0; k < motion.size(); ++k)
        turn_[k] = motion[k].before.orientation.angularDistance(motion[k].after.orientation);
    chunks_.resize(std::max(chunks_.size(), Workers::chunk_count(from.size())));
    workers.for_chunks(from.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        Stopped& out = chunks_[chunk];
        out.report = {};
        out.reactions.clear();
        if (out.reactions.capacity() == 0) out.reactions.reserve(64); // few particles of a chunk are stopped at once
        find_near(from.subspan(begin, end - begin), to.subspan(begin, end - begin), motion, out.near);
        for (std::size_t i = begin; i < end; ++i) {
            if (!to[i].allFinite()) continue; // counted by the step as physics in trouble
            if (!may_hit(from[i].head<3>().cast<double>(), to[i].head<3>().cast<double>(), motion, out.near)) continue;
            stop_one(from[i], to[i], velocity[i], motion, particle_mass, out);
        }
    });
    GuardReport report;
    for (std::size_t chunk = 0; chunk < Workers::chunk_count(from.size()); ++chunk) {
        report.stopped += chunks_[chunk].report.stopped;
        report.leaked += chunks_[chunk].report.leaked;
        for (const Reaction& r : chunks_[chunk].reactions) impulses[r.surface] += r.impulse;
    }
    return report;
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

void WallGuard::stop_one(const Vec4& from, Vec4& to, Vec4& velocity, std::span<const GuardedMotion> motion,
                         double particle_mass, Stopped& out) const
{
    constexpr int kMaxBounces = 4; // a corner of three walls takes three
    const Vec3d a = from.head<3>().cast<double>();
    Vec3d b = to.head<3>().cast<double>();
    Vec3d v = velocity.head<3>().cast<double>();
    std::optional<std::size_t> stopped_by;
    Vec3d spin = b.cross(v); // angular momentum per mass that no surface has been given yet
    const auto give = [&](std::size_t k, const Vec3d& at, const Vec3d& impulse) {
        out.reactions.push_back({k, {impulse, (at - motion[k].before.position).cross(impulse)}});
        spin -= at.cross(impulse) / particle_mass;
    };
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
            give(hit->surface, at, particle_mass * approach * hit->normal);
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
            give(*stopped_by, at, particle_mass * (v - keeper_velocity));
            v = keeper_velocity;
            if (other && !stands(keeper)) ++out.report.leaked;
        }
    }
    if (!stopped_by) return;
    ++out.report.stopped;
    to.head<3>() = b.cast<Scalar>();
    velocity.head<3>() = v.cast<Scalar>();
    // Putting the particle back moved it off the straight line: the surface takes the difference, so that none is lost.
    out.reactions.push_back({*stopped_by, {Vec3d::Zero(), particle_mass * (spin - b.cross(v))}});
}

} // namespace flotsam
