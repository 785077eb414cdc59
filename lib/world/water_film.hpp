#pragma once

#include "flotsam/geometry/surface_query.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "geometry/disjoint_sets.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/triangle_pieces.hpp"
#include "sph/contacts.hpp"
#include "world/wall_guard.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// A wall or a body between which and another one there may be a film.
struct FilmSolid {
    const SurfaceQuery* query = nullptr; ///< null: there is none
    Pose pose;
    Twist twist;                       ///< at the start of the step, about the pose's position
    WallSide side = WallSide::outside; ///< where its water is
    bool responds = false;
};

struct WaterFilmSettings {
    double spacing = 0.0; ///< [m]
    Vec3d gravity = Vec3d::Zero();
    double rest_density = 0.0;
    int dimensions = 3;
    double delay = 0.0; ///< in which a film takes the pressure around it [s]
};

/// The fluid in one step, as films look at it.
struct FilmWater {
    const FluidState& fluid; ///< pressures of the last step
    const SelfPairs& fluid_pairs;
    const Pairs& boundary_pairs;
    const Contacts& contacts;
    std::span<const std::int32_t> sample_owner;
    std::span<const char> is_pinched; ///< of each particle: it has no pressure, and takes no film's place
};

/// The water between solids that are closer to each other than a particle is wide: no particle gets in, but real water
/// does, and without its pressure a body that lies flush on a floor would be held down like a suction cup. Where a face
/// of a body that responds has another solid in front of it, and no particle between, it bears the pressure of the
/// water around that place, continued by hydrostatics, and the other solid bears the same the other way:
///
///     p(x) = wet (P + rho0 g . (x - X))
///
/// with P and X the means of the particles next to the film that touch no solid, and `wet` the part of the film's rim
/// that has particles: there is air, or no way in, at the rest of it. A rim at which the faces part slowly counts where
/// they are closer than a tenth of a spacing: particles that are pressed into a wedge push the rest of its faces apart
/// as a film would. (A disc of 6 or 12 spacings in radius on the floor lacks the pressure of a strip of 1.5 or 2.3
/// spacings.) Of P, rho0 u^2 / 2 goes
/// where the gap opens, u the speed at which water flows in at the rim. Films follow P with a delay, since what they do
/// is not part of the pressure system (as rows of it, they compressed the particles at their rims by a third: there is
/// no place for what flows in). p is at most 1.5 of that of still water under the highest particle: else solids that
/// films push apart would squeeze water elsewhere, whose pressure would feed other films. Inertia and friction of the
/// film (the squeeze film of lubrication theory) are left out.
class WaterFilms {
  public:
    /// Finds the films between `solids`, one for each owner of samples. `guard` has bounds of the distances to the
    /// solids.
    void fill(const WaterFilmSettings& settings, double dt, const FilmWater& water, std::span<const FilmSolid> solids,
              const WallGuard& guard);

    [[nodiscard]] bool empty() const { return films_.empty(); }

    /// Leaves of each film what is the least of `share`, 0 to 1, of its two owners.
    void limit(std::span<const double> share);

    /// Adds the impulses of the films in `dt` seconds [N s], each about the position of the owner's pose.
    void add_impulses(double dt, std::span<Wrench> impulses) const;

    /// The surface of this owner is another one now, or gone.
    void forget(std::size_t owner);

    /// Adds what films pressed in the last step on the triangles of an owner, of those whose faces they were found
    /// from: p times area [N].
    void add_to_triangles(std::size_t owner, std::span<double> force) const;

  private:
    /// A particle that touches two solids.
    struct Touch {
        std::uint32_t a, b, particle;
        auto operator<=>(const Touch&) const = default;
    };
    /// A part of a face that has another solid in front of it, world frame.
    struct Facing {
        Vec3d center, normal;
        Vec3d middle;        ///< of the gap
        double area;         ///< [m^2]
        double gap;          ///< [m]
        double slope;        ///< sine of the angle between the faces
        double share;        ///< that is a film's, not the particles'
        std::uint32_t part;  ///< of the body's Faces
        std::size_t set = 0; ///< its film
        bool is_rim = false;
    };
    /// A body's faces in parts.
    struct Faces {
        bool is_cut = false;
        std::vector<TrianglePiece> parts;      ///< in the body's frame
        std::vector<double> pressure;          ///< that films have on them [Pa]
        std::vector<std::uint32_t> last_steps; ///< number of the last step in which they were in a film
    };
    struct Film {
        std::size_t a, b;
        double share = 1.0;                ///< that limit has left
        Wrench on_a, on_b;                 ///< [N], [N m]
        std::size_t first_part, last_part; ///< of pressed_
    };
    struct PressedPart {
        std::size_t triangle; ///< of a
        double force;         ///< p times area [N]
    };
    /// The rim of a film.
    struct Rim {
        double wet = 0.0;    ///< the part of it that has particles, in front of a step
        double wedge = 0.0;  ///< in a wedge
        double length = 0.0; ///< of that part [m; in 2-D their number]
    };
    /// Pressure of the water around a film [Pa], at a place.
    struct Around {
        double pressure = 0.0;
        Vec3d place = Vec3d::Zero();
    };

    void find_top(const FluidState& fluid);
    void cut(Faces& faces, const TriangleMesh& mesh);
    void find_touches(const FilmWater& water, std::span<const FilmSolid> solids);
    void find_facing(std::size_t a, std::size_t b, std::span<const FilmSolid> solids, const WallGuard& guard);
    void leave_to_particles(std::span<const Touch> touches, const FluidState& fluid);
    void join_and_find_rims();
    [[nodiscard]] Rim weigh_rim(std::span<const Facing> parts, std::size_t particles);
    [[nodiscard]] Around pressure_around(std::span<const Touch> touches, const FilmWater& water) const;
    [[nodiscard]] double inflow_head(std::span<const Facing> parts, const Rim& rim, const FilmSolid& a,
                                     const FilmSolid& b) const;
    void press(std::span<const Facing> parts, const Rim& rim, const Around& around, double dt, std::size_t a,
               std::size_t b, std::span<const FilmSolid> solids);

    WaterFilmSettings settings_;
    std::uint32_t step_ = 0;
    double top_ = 0.0;                    ///< gravity . x of the highest particle [m^2/s^2]
    std::vector<Faces> faces_;            ///< by owner
    std::vector<std::uint8_t> owners_at_; ///< of each particle, at most 2
    std::vector<Touch> touches_;          ///< sorted
    std::vector<Facing> facing_;          ///< of a pair of solids
    std::vector<Vec3d> points_;
    PointGrid particles_, parts_; ///< of a pair's touches, of facing_
    DisjointSets sets_;
    std::vector<double> weight_; ///< of a pair's touches
    std::vector<Film> films_;
    std::vector<PressedPart> pressed_;
};

} // namespace flotsam
