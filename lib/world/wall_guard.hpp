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
/// toward the surface is taken away, and the momentum is given to the surface's owner: where that is a body which
/// yields, only as much as leaves the least kinetic energy. (One of half a particle's mass would be thrown off at three
/// times the particle's speed by all of it.) A particle that a body squeezes against a wall stays in front of the wall,
/// in the skin of the body, and is not counted as leaked. A cheap bound of the distance clears nearly all particles;
/// the rest ask SurfaceQuery.
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

    /// Answers impulses on the surfaces' owners with the twist changes that they cause.
    using Response = FunctionRef<void(std::span<const Wrench> impulses, std::span<Twist> changes)>;

    /// `from` and `to`: positions at both ends of the step; `to` and `velocity` are corrected. `impulses`: one per
    /// surface, about motion.before.position, written. `response` may be null: no owner yields.
    GuardReport stop(std::span<const Vec4> from, std::span<Vec4> to, std::span<Vec4> velocity,
                     std::span<const GuardedMotion> motion, double particle_mass, const Workers& workers,
                     const Response* response, std::span<Wrench> impulses);

  private:
    struct Push {
        std::size_t surface;
        Vec3d at, impulse; ///< that it is given whole [m], [N s]
    };
    /// A particle that was stopped.
    struct Stop {
        std::size_t particle, keeper; ///< the surface that has it
        Vec3d position, velocity;     ///< if all pushes were given whole
        Vec3d spin;                   ///< angular momentum per mass before it was stopped [m^2/s]
        std::size_t pushes;           ///< of the chunk, up to this one's last
    };
    struct Stopped {
        GuardReport report;
        std::vector<Stop> stops;
        std::vector<Push> pushes;
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
    void stop_one(std::size_t i, const Vec4& from, Vec4& to, const Vec4& velocity,
                  std::span<const GuardedMotion> motion, double particle_mass, Stopped& out) const;
    void find_shares(std::size_t chunks, std::span<const GuardedMotion> motion, double particle_mass,
                     const Response& response, std::span<Wrench> whole);
    void give(const Stopped& chunk, std::span<const GuardedMotion> motion, double particle_mass,
              std::span<Vec4> velocity, std::span<Wrench> impulses) const;

    std::vector<GuardedSurface> surfaces_;
    std::vector<std::optional<DistanceBounds>> bounds_;
    std::vector<double> reach_; ///< of each surface, from the origin of its mesh [m]
    std::vector<double> turn_;  ///< of each owner in the step under way [rad]
    double clearance_ = 0.0;    ///< how far in front of a surface a stopped particle is put [m]
    std::vector<Stopped> chunks_;
    std::vector<double> shares_, lost_; ///< of each surface: of its pushes that it is given; their energy [J]
    std::vector<Twist> changes_;
};

} // namespace flotsam
