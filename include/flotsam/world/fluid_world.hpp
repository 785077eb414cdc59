#pragma once

#include "flotsam/geometry/surface_samples.hpp"
#include "flotsam/geometry/triangle_mesh.hpp"
#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/pressure/settings.hpp"
#include "flotsam/world/bodies.hpp"
#include "flotsam/world/fluid_forces.hpp"
#include "flotsam/world/step_report.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flotsam {

/// Settings of a FluidWorld. Every field changes the result.
struct FluidWorldSettings {
    int dimensions = 3;                     ///< 2 or 3; 2: the plane y = 0, quantities per metre of width
    double particle_spacing = 0.02;         ///< d [m], > 0
    Vec3d gravity = Vec3d(0.0, 0.0, -9.81); ///< [m/s^2]
    double rest_density = 1000.0;           ///< [kg/m^3], > 0
    double kinematic_viscosity = 1e-6;      ///< [m^2/s], >= 0
    double dissipation = 2.0;               ///< of velocity noise below the resolution, x d |dv|; 0: none, >= 0
    double packing_relief = 0.75;           ///< share of the packing's anisotropic stress taken away, in [0, 1]
    KernelKind kernel = KernelKind::quintic;
    PressureSettings pressure{};
    double max_time_step = 0.004; ///< [s], > 0
    double cfl = 0.4;             ///< of a spacing that the fastest particle may go in a step, in (0, 1]
    /// at_rest: the water is still from the first step on, around the bodies as they stand; see FluidWorld::prepare.
    enum class Start { as_given, at_rest } start = Start::as_given;
    int threads = 0; ///< 0: all the machine has; changes no bit of the result
};

/// Where the water is, seen from a wall's triangles.
enum class WallSide {
    automatic, ///< found from the fluid that is there when the world is first stepped
    inside,    ///< behind the triangles: the mesh is a container
    outside,   ///< in front of them: the mesh is a solid obstacle or a tank with walls of its own thickness
    both       ///< a sheet with water on both sides
};

/// An SPH fluid, its walls and the boundary samples of the bodies that it moves and is moved by.
///
/// First walls, bodies and fluid are added, in any order; the first step (or prepare) cuts the fluid by the solids,
/// samples surfaces and relaxes the particles to rest density. Not thread-safe; several worlds live side by side.
class FluidWorld {
  public:
    /// Throws std::invalid_argument naming the setting, its range and unit.
    explicit FluidWorld(const FluidWorldSettings& settings);
    ~FluidWorld();
    FluidWorld(FluidWorld&&) noexcept;
    FluidWorld& operator=(FluidWorld&&) noexcept;
    FluidWorld(const FluidWorld&) = delete;
    FluidWorld& operator=(const FluidWorld&) = delete;

    // -- building, before the first step --------------------------------------------------------------------------
    // Meshes are taken as they are (check_mesh repairs them); std::invalid_argument for one without triangles, with
    // corners that are none of its vertices or are not finite, and for bodies and water whose triangles face inward.
    /// Water in a box [m]; what lies inside walls or bodies is cut away. `velocity` [m/s], here and below zero for
    /// water that starts at rest.
    void add_block(const Aabb& block, const Vec3d& velocity = Vec3d::Zero());
    /// Water inside a closed, checked mesh.
    void add_fluid_mesh(const TriangleMesh& closed, const Vec3d& velocity = Vec3d::Zero());
    /// Single particles where the caller wants them [m]; never cut, never relaxed.
    void add_particles(std::span<const Vec3d> positions, const Vec3d& velocity = Vec3d::Zero());
    /// A fixed wall; returns its number.
    int add_wall(const TriangleMesh& mesh, WallSide side = WallSide::automatic);
    /// A box around water with some sides open ("+z", ...); returns its number.
    int add_box_wall(const Aabb& box, const std::vector<std::string>& open = {});
    /// A body as a closed mesh about its centre of mass; returns its number, the one it has in the Bodies port. Between
    /// steps too: water in its place is removed.
    int add_body(const TriangleMesh& closed_about_center_of_mass);
    /// Its number stays, for nobody; where it was, water flows in.
    void remove_body(int body);
    /// Another surface from now on; water in its place is removed.
    void reshape_body(int body, const TriangleMesh& closed_about_center_of_mass);
    /// What notes call a wall or a body; else they say "wall 0", "body 0".
    void name_wall(int wall, const std::string& name);
    void name_body(int body, const std::string& name);
    /// Cuts, samples and relaxes now rather than in the first step; repeated calls do nothing. A call that is refused
    /// (std::invalid_argument: the port has other bodies than the world) changes nothing.
    ///
    /// With FluidWorldSettings::Start::at_rest the water is then brought to rest, by damped steps
    ///     v <- 0.95 (v + dt (g + a)),   x <- x + dt (v + dt (g + a)) + shift,   dt = 0.45 d / sqrt(p_max / rho),
    /// with a the acceleration by pressure and the shift of the split source, 20 to 400 of them, until the mean speed
    /// is under 0.004 sqrt(g d); then v = 0. Bodies stand still and get no impulse, time stays 0, the ledger empty. The
    /// last pressure is the start of the first step's solve. Water that nothing carries, a drop in the air, waits where
    /// it is, as do single particles. What cannot come to rest (a dam about to break) flows on for as long, and a note
    /// says so. Nothing is done without gravity. Same bits for any number of threads; costs about as much as 300 steps.
    /// `on_round`, if there is one, is called after each of them; if it throws, the next call, or step, goes on.
    void prepare(Bodies& bodies, const std::function<void(const SettleProgress&)>& on_round = {});

    // -- stepping -------------------------------------------------------------------------------------------------
    /// The largest step that settings.max_time_step, CFL and viscosity allow now [s].
    [[nodiscard]] double allowed_time_step() const;
    /// One step of `dt` seconds, > 0. The bodies get their impulses through the port; moving them is their engine's
    /// work. Throws std::invalid_argument, before anything has changed, where the port has other bodies than the world
    /// or gives one a pose or a velocity that is not finite.
    StepReport step(double dt, Bodies& bodies);

    // -- reading --------------------------------------------------------------------------------------------------
    [[nodiscard]] const FluidWorldSettings& settings() const;
    [[nodiscard]] double time() const; ///< simulated [s]
    [[nodiscard]] const FluidState& fluid() const;
    [[nodiscard]] const BoundaryState& boundary() const;
    [[nodiscard]] int wall_count() const;
    [[nodiscard]] int body_count() const;
    /// Mesh of wall k, as sampled: its triangles' normals point away from the water unless the side is `outside`.
    [[nodiscard]] const TriangleMesh& wall_mesh(int wall) const;
    /// Force [N] and torque [N m] that the fluid put on a body about its centre of mass, mean over the last step.
    [[nodiscard]] Wrench fluid_wrench(int body) const;
    /// The same by cause, of any body: dynamic, fixed or moving. Nothing of it is reckoned before it is asked for.
    /// The hydrostatic part is exact: rho g times the volume of the mesh under the water line, at its centre. Where
    /// there is no water line (gravity not down the z axis) a body that water touches counts as wholly under it; one
    /// that none touches, and any without gravity, has no hydrostatic part.
    [[nodiscard]] FluidForces fluid_forces(int body) const;
    /// The same, with torques about a point of the world.
    [[nodiscard]] FluidForces fluid_forces(int body, const Vec3d& about) const;
    /// Pressure force at each boundary sample of a body. They sum to the pressure's part of the force, to rounding.
    [[nodiscard]] std::vector<SampleForce> sample_forces(int body) const;
    /// Pressure [Pa] on each triangle of a body's mesh, mean over the last step.
    ///
    /// Each particle's push is spread over the surface within about two spacings that it presses on, so that
    /// -sum p A n is the pressure force but for what is along a flat surface: within 1.5 % of the displaced weight for
    /// held boxes and balls. Means over faces are within some per cent of rho g times their depth; single values
    /// tremble, so average them over some steps. Through a solid thinner than two spacings water presses on water, and
    /// values are too small (0.6 of it on a plate of half a spacing). In two dimensions the mesh counts as a prism
    /// along y, whose ends feel nothing.
    [[nodiscard]] std::vector<double> surface_pressure(int body) const;
    /// Force [N] that the fluid put on a wall, mean over the last step.
    [[nodiscard]] Vec3d wall_force(int wall) const;
    /// The same by cause, with torques about the world's origin.
    [[nodiscard]] ByCause<Wrench> wall_wrench(int wall) const;
    /// The ledgers of all steps since the first, added up.
    [[nodiscard]] const Ledger& ledger() const;
    /// Pressure [Pa] at a point, of the forces between the particles around it, each continued along the hydrostatic
    /// gradient to the point; 0 where there is no fluid.
    [[nodiscard]] double pressure_at(const Vec3d& point) const;
    /// Height [m] of the water's surface on the vertical line through (x, y): a little above (0.05 to 0.16 spacings, by
    /// kernel) where the smoothed volume fraction falls through 1/2, because the uppermost layers are packed closer
    /// than others, so that a still tank's level is that of its volume; nothing where the line meets no water.
    [[nodiscard]] std::optional<double> level_at(double x, double y) const;
    /// Height [m] of the undisturbed water: median of levels taken away from the bodies (`states`: where they are), or,
    /// where bodies leave no room for that, of what is open between them; nothing where there is no open water.
    [[nodiscard]] std::optional<double> waterline(std::span<const BodyState> states) const;
    /// The same of the water that each body is in, where several basins stand at different levels. Waters are one that
    /// hang together through particles a spacing or more below the lower level, so that an overflow joins none; what
    /// lies under a ceiling is no surface. A body without water at it is in that straight under its middle; one that
    /// stands in two waters has the median of both, if both are deep enough. In one without a surface it has
    /// waterline(states), as all bodies have before the first step; what is in no water and over none has nothing.
    [[nodiscard]] std::vector<std::optional<double>> waterlines(std::span<const BodyState> states) const;
    /// What prepare noticed, a sentence each: fluid cut by bodies, thin solids sampled in one layer, ...
    [[nodiscard]] const std::vector<std::string>& notes() const;
    /// Of positions and velocities in order of creation, and of the time: equal states hash equal.
    [[nodiscard]] std::uint64_t state_hash() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotsam
