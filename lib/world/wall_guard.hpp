#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/geometry/surface_query.hpp"
#include "world/distance_bounds.hpp"

#include <optional>
#include <span>
#include <vector>

namespace flotsam {

/// A surface that particles may not pass.
struct GuardedSurface {
    const SurfaceQuery* query = nullptr;
    bool stops_along_normals = false;  ///< motion along the triangles' normals is stopped: a container
    bool stops_against_normals = true; ///< motion against them is stopped: a body
};

/// Where a guarded surface is at both ends of a step.
struct GuardedMotion {
    Pose before, after;
    Twist twist; ///< about before.position
};

/// What the guard did in one step.
struct GuardReport {
    int stopped = 0; ///< particles put back in front of a surface
    int leaked = 0;  ///< particles that could not be kept
};

/// Stops particles whose path in this step would pass through a surface: each is put back in front of it, its velocity
/// toward the surface is taken away, and the momentum is given to the surface's owner. One that a body squeezes against
/// a wall stays in front of the wall, in the skin of the body, and is not counted as leaked. A cheap bound of the
/// distance clears nearly all particles; the rest ask SurfaceQuery.
class WallGuard {
  public:
    void build(const std::vector<GuardedSurface>& surfaces, double particle_spacing, const Workers& workers);
    [[nodiscard]] std::size_t surfaces() const { return surfaces_.size(); }
    /// Replaces surface k, or adds it where k is their number; one without a query stops nothing.
    void change(std::size_t k, const GuardedSurface& surface, double particle_spacing, const Workers& workers);

    /// A lower bound of the distance from a point, in the owner's frame, to surface k [m]; of no use far away.
    [[nodiscard]] double distance_bound(std::size_t k, const Vec3d& point) const
    {
        return bounds_[k] ? bounds_[k]->rough_at(point) : 1e300;
    }

    /// `from` and `to`: positions at both ends of the step; `to` and `velocity` are corrected. `impulses`: one per
    /// surface, about motion.before.position, added to.
    GuardReport stop(std::span<const Vec4> from, std::span<Vec4> to, std::span<Vec4> velocity,
                     std::span<const GuardedMotion> motion, double particle_mass, const Workers& workers,
                     std::span<Wrench> impulses);

  private:
    struct Reaction {
        std::size_t surface;
        Wrench impulse;
    };
    struct Stopped {
        GuardReport report;
        std::vector<Reaction> reactions;
        std::vector<std::size_t> near; ///< surfaces that a particle of the chunk might meet
    };
    struct Hit {
        std::size_t surface;
        double fraction;
        Vec3d normal; ///< world frame, against the motion
    };
    [[nodiscard]] bool passes_far(std::size_t k, const Vec3d& from, const Vec3d& to, const GuardedMotion& motion) const;
    void find_near(std::span<const Vec4> from, std::span<const Vec4> to, std::span<const GuardedMotion> motion,
                   std::vector<std::size_t>& near) const;
    [[nodiscard]] bool may_hit(const Vec3d& from, const Vec3d& to, std::span<const GuardedMotion> motion,
                               std::span<const std::size_t> near) const;
    [[nodiscard]] std::optional<Hit> first_hit(const Vec3d& from, const Vec3d& to,
                                               std::span<const GuardedMotion> motion) const;
    void stop_one(const Vec4& from, Vec4& to, Vec4& velocity, std::span<const GuardedMotion> motion,
                  double particle_mass, Stopped& out) const;

    std::vector<GuardedSurface> surfaces_;
    std::vector<std::optional<DistanceBounds>> bounds_;
    std::vector<double> reach_; ///< of each surface, from the origin of its mesh [m]
    std::vector<double> turn_;  ///< of each owner in the step under way [rad]
    double clearance_ = 0.0;    ///< how far in front of a surface a stopped particle is put [m]
    std::vector<Stopped> chunks_;
};

} // namespace flotsam
