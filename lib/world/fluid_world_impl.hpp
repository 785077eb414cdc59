#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/geometry/surface_query.hpp"
#include "flotsam/geometry/surface_samples.hpp"
#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "geometry/basin_query.hpp"
#include "sph/contacts.hpp"
#include "sph/forces/packing_stress.hpp"
#include "sph/forces/recent_slip.hpp"
#include "sph/forces/skin_friction.hpp"
#include "sph/forces/viscosity.hpp"
#include "sph/pressure/complementarity_solver.hpp"
#include "sph/pressure/pressure_system.hpp"
#include "sph/pressure/response_preconditioner.hpp"
#include "world/boundary_calibration.hpp"
#include "world/box_rooms.hpp"
#include "world/enclosed_water.hpp"
#include "world/keep_ledger.hpp"
#include "world/sheet_screen.hpp"
#include "world/wall_guard.hpp"
#include "world/water_film.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace flotsam {

/// A wall: a fixed surface with water on one side (or both).
struct Wall {
    TriangleMesh mesh;
    std::string name; ///< in notes
    WallSide side = WallSide::automatic;
    std::optional<Aabb> box; ///< of a box wall
    OpenSides open = {};     ///< of a box wall
    std::unique_ptr<SurfaceQuery> query;
    std::unique_ptr<SurfaceSampler> sampler; ///< of parts that no water has come near yet; null: there are none
    bool is_noted_thin = false;
    std::unique_ptr<Sheet> sheet; ///< null: it is none
};

/// A body's surface about its centre of mass.
struct BodySurface {
    TriangleMesh mesh; ///< empty: removed
    std::string name;  ///< in notes
    std::unique_ptr<SurfaceQuery> query;
    std::unique_ptr<Sheet> sheet;  ///< null: it is none
    double thin_fraction = 0.0;    ///< of its surface: sampled in one layer in its middle
    bool is_changed = false;       ///< added or reshaped since the last step
    std::optional<Pose> last_pose; ///< at the end of the last step, as the fluid had it; at first where it was placed

    /// Radius about the centre of mass that holds all of it [m]; needs the query.
    [[nodiscard]] double reach() const
    {
        const Aabb box = query->bounds();
        return box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).norm();
    }
};

/// A body with basins that the water around it does not reach.
struct Vessel {
    std::size_t body;
    Aabb bounds; ///< in the world
    BasinQuery basins;
};

/// Water that was asked for, before it is cut.
struct FluidSeed {
    std::vector<Vec3d> positions;
    Vec3d velocity = Vec3d::Zero();
    bool cut = true;
    std::function<bool(const Vec3d&)> covers; ///< whether a point is in the region that was filled; may be empty
};

/// Largest of terms, for ordered_sum.
struct MaxOf {
    double value = 0.0;
    MaxOf& operator+=(const MaxOf& other)
    {
        value = std::max(value, other.value);
        return *this;
    }
};

struct SoundingLine;

struct FluidWorld::Impl {
    explicit Impl(const FluidWorldSettings& settings);

    FluidWorldSettings settings;
    Workers workers;
    Kernel kernel;
    double time = 0.0;
    double max_pressure = 0.0;  ///< of the last step; before it the hydrostatic one [Pa]
    double max_speed = 0.0;     ///< of fluid and bodies [m/s]
    double deepest_catch = 0.0; ///< water that is further down along gravity is gone [m]
    bool prepared = false;      ///< the water is placed: no wall and no water is added any more
    bool is_settled = false;    ///< prepare has come to its end
    bool is_stepping = false;
    bool is_gravity_noted = false;
    std::vector<std::string> notes;

    std::vector<FluidSeed> seeds;
    std::vector<char> placed; ///< by id: put there as a single particle, not to be relaxed
    std::vector<Wall> walls;
    std::vector<BodySurface> bodies;

    FluidState fluid;
    BoundaryState boundary;

    // -- of the step under way, kept for their capacity -------------------------------------------------------------
    CellGrid grid;
    CellLists fluid_cells, boundary_cells;
    NeighbourSearch search;
    SelfPairs fluid_pairs;
    Pairs boundary_pairs;
    SheetScreen screen;
    std::size_t paired_samples = 0; ///< boundary samples that there were when boundary_pairs was found
    ContactBuilder contact_builder;
    Contacts contacts;
    Viscosity viscosity;
    SkinFriction skin_friction;
    RecentSlip slip;
    PackingStress packing_stress;
    WaterFilms films;
    RelaxedJacobi relaxed_jacobi;
    Mprgp mprgp;
    SpectralGradient spectral_gradient;
    PressureOperator pressure_operator;
    ResponsePreconditioner preconditioner;
    WallGuard guard;
    std::vector<BodyState> states;
    std::vector<BodyState> read_states; ///< as the port gave them, before they are checked
    std::vector<Vec3d> centers;         ///< of each owner
    std::vector<Twist> twists;          ///< of each owner, predicted
    std::vector<Wrench> pushed;         ///< pressure impulses of each owner [N s]
    std::vector<Wrench> rubbed;         ///< viscous impulses of each owner [N s]
    std::vector<Wrench> relieved;       ///< those of packing_relief [N s]
    std::vector<Wrench> filmed;         ///< those of films between solids [N s]
    std::vector<Wrench> total;          ///< of each owner over the last step [N s]
    std::vector<Wrench> offered;        ///< total and pushed, while joints and contacts are asked about them [N s]
    std::vector<Vec4> predicted;
    std::vector<Vec4> shift;
    /// Scratch of sorting, forces and the pressure system until they are written; between steps new_position has where
    /// the particles were when the pairs were found.
    std::vector<Vec4> new_position, new_velocity;
    EnclosedWater enclosed_water;
    PressureSystem::Scratch pressure_scratch; ///< the forces' before; change: by pressure [m/s]
    std::vector<Scalar> multiplier, source;   ///< source: scratch of sorting before
    std::vector<Scalar> fluid_diagonal, coupled_diagonal;
    std::vector<char> is_pinched; ///< of each particle: between solids that all but touch
    std::vector<Eigen::Matrix<double, 6, 6>> mobility;
    std::vector<double> sums;
    std::vector<MaxOf> max_scratch;
    std::vector<char> reached_parts; ///< of a wall
    std::vector<Wrench> unit;
    std::vector<FilmSolid> film_solids; ///< by owner
    std::vector<double> film_shares;    ///< by owner
    std::vector<Twist> answer;
    std::vector<GuardedMotion> motion;
    std::vector<Wrench> guarded;
    std::vector<LedgerSums> ledger_scratch;
    Ledger ledger; ///< of all steps
    double last_dt = 0.0;
    int failed_shifts = 0;       ///< in a row
    int steps_without_shift = 0; ///< still to come
    int steps_enclosed = 0;      ///< still to come, in which water counts as enclosed by solids

    [[nodiscard]] std::size_t owners() const { return walls.size() + bodies.size(); }
    [[nodiscard]] double spacing() const { return settings.particle_spacing; }
    [[nodiscard]] double support() const { return static_cast<double>(kernel.support()); }

    // fluid_world.cpp
    void require_still_if_at_rest(const Vec3d& velocity) const;
    [[nodiscard]] double pressure_time_step() const;

    // readings.cpp
    enum class Readable { any, free, bulk };
    [[nodiscard]] Readable readable(std::size_t i) const;
    [[nodiscard]] double gauge_pressure(std::size_t i) const;

    // waterline.cpp
    [[nodiscard]] bool line_passes_body(std::span<const BodyState> at, double x, double y, double away) const;
    [[nodiscard]] bool touches_body(std::span<const BodyState> at, const Vec3d& point, double away) const;
    template <class Visit>
    void sound(const FluidWorld& world, std::span<const BodyState> at, bool is_fine, double away, double clear,
               Visit&& visit) const;
    [[nodiscard]] bool has_pairs() const;
    [[nodiscard]] bool wall_parts(const Vec3d& a, const Vec3d& b) const;
    [[nodiscard]] std::vector<std::uint32_t> column_at(double x, double y, double beyond) const;
    [[nodiscard]] std::vector<std::vector<std::uint32_t>> particles_at(std::span<const BodyState> at) const;
    [[nodiscard]] std::optional<SoundingLine> line_at(double x, double y, double level) const;

    // forces_on_bodies.cpp, surface_pressure.cpp
    [[nodiscard]] bool is_touched(std::size_t owner) const;
    [[nodiscard]] bool has_pushes(std::size_t owner) const;
    [[nodiscard]] ByCause<Wrench> wrenches(std::size_t owner) const;
    [[nodiscard]] Wrench hydrostatic(std::size_t body, std::optional<double> level) const;
    template <class Visit>
    void visit_pushes(std::size_t owner, Visit&& visit) const;

    // prepare.cpp
    void prepare(Bodies& port, const std::function<void(const SettleProgress&)>& on_round = {});
    [[nodiscard]] double mean_winding(const Wall& wall) const;
    void choose_wall_sides();
    void place_water();
    [[nodiscard]] std::vector<Vessel> find_vessels() const;
    void leave_out_doubles(std::size_t seed, const std::vector<Vessel>& vessels, std::vector<char>& keep);
    void bail_out(const FluidSeed& seed, const std::vector<Vessel>& vessels, std::vector<char>& keep);
    void cut_and_place_fluid();
    void look_around(StepReport& report);
    void relax(int max_rounds);
    void guard_relaxation();
    [[nodiscard]] double enclosed_room() const;
    [[nodiscard]] bool is_overfull();
    void loosen_enclosed_water();
    [[nodiscard]] bool in_solid(const Vec3d& point) const;
    [[nodiscard]] bool in_body(std::size_t k, const Pose& pose, const Vec3d& point) const;

    // sample_surfaces.cpp
    void sample_surfaces();
    void sample_body(std::size_t k);
    bool copy_samples_of_twin(std::size_t k);
    void prepare_wall_samples(std::size_t k);
    void find_reached_parts(const Wall& wall);
    void sample_walls_in_reach();
    [[nodiscard]] BoundaryCalibration calibration() const;
    [[nodiscard]] double sample_inset() const;
    [[nodiscard]] SurfaceSampleSettings sample_settings(SurfaceSampleSettings::Solid solid) const;
    void add_samples(std::size_t owner, const SurfaceSamples& samples, std::span<const double> volumes);
    [[nodiscard]] std::vector<double> volumes_of(const SurfaceSamples& samples, const SurfaceSamples& around) const;
    [[nodiscard]] SurfaceSampleSettings wall_sampling(const Wall& wall) const;
    [[nodiscard]] std::unique_ptr<Sheet> sheet_of(const SurfaceQuery& query, const SurfaceSampleSettings& sampling,
                                                  const SurfaceSamples& samples) const;
    void note_thin(const std::string& name, double fraction);

    // settle.cpp
    void settle(const std::function<void(const SettleProgress&)>& on_round);
    [[nodiscard]] double settle_round(double dt, Bodies& held);
    [[nodiscard]] bool is_carried(std::size_t i) const;

    // change_bodies.cpp
    void require_no_step() const;
    [[nodiscard]] BodySurface& body(int number);
    void remove_samples(std::size_t owner);
    void take_in_changes(StepReport& report);
    [[nodiscard]] bool has_jumped(std::size_t k) const;
    void make_room(std::size_t k, StepReport& report);
    void remove_particles(std::span<const std::uint32_t> rising, StepReport& report);

    // fallen_water.cpp
    void find_deepest_catch();
    void remove_fallen(StepReport& report);

    // step.cpp
    StepReport step(double dt, Bodies& port);
    void read_bodies(double dt, Bodies& port);
    void note_other_gravity(const Bodies& port);
    void place_body_samples();
    void find_neighbours();
    void hide_behind_sheets();
    void sort_particles();
    void measure_density(StepReport& report);
    void add_forces(double dt, Bodies& port, StepReport& report);
    void fill_films(double dt, Bodies& port);
    void solve_pressure(double dt, Bodies& port, StepReport& report);
    void respond(Bodies& port, std::span<const Wrench> impulses, std::span<Twist> answers) const;
    void predict_twists(Bodies& port);
    void build_mobility(Bodies& port);
    void find_mobility(Bodies& port);
    void find_pinched();
    void solve_velocities(const PressureSystem& system, double dt, bool split, Bodies& port, StepReport& report);
    [[nodiscard]] bool revise(Bodies& port);
    [[nodiscard]] bool is_strong() const
    {
        return settings.pressure.coupling == PressureSettings::Coupling::strong && !bodies.empty();
    }
    [[nodiscard]] PressureSystem pressure_system();
    [[nodiscard]] SolveResult solve_shift(const PressureSystem& system);
    [[nodiscard]] double mean_length(std::span<const Vec4> vectors);
    [[nodiscard]] double part_of_cold_residual(double scale);
    [[nodiscard]] double velocity_tolerance(double dt);
    [[nodiscard]] bool is_enclosed(const SolveResult& of_shift);
    [[nodiscard]] bool shift_if_possible(const PressureSystem& system, StepReport& report);
    void advance(double dt, Bodies& port, StepReport& report);
    void guard_walls(double dt, Bodies& port, StepReport& report);
    [[nodiscard]] ComplementaritySolver& solver();

    // keep_ledger.cpp
    [[nodiscard]] LedgerSums ledger_terms(std::size_t i, double dt) const;
    void book_owner(std::size_t k, ByCause<Wrench>& impulses, ByCause<double>& work) const;
    void keep_ledger(double dt, Bodies& port, StepReport& report);
};

/// Calls visit(i, b, force) for the pressure force [N] of each particle i on each sample b of an owner in the last
/// step, i rising; has_pushes must hold: the terms that Contacts has summed up, m p_i / rho_i^2 rho0 V_b grad W_ib.
template <class Visit>
void FluidWorld::Impl::visit_pushes(std::size_t owner, Visit&& visit) const
{
    const double share = fluid.particle_mass * settings.rest_density / last_dt;
    for (std::uint32_t k = contacts.start[owner]; k < contacts.start[owner + 1]; ++k) {
        const std::uint32_t i = contacts.particle[k];
        const double push = share * static_cast<double>(multiplier[i]);
        for (std::uint32_t p = boundary_pairs.start[i]; p < boundary_pairs.start[i + 1]; ++p) {
            const std::uint32_t b = boundary_pairs.index[p];
            if (boundary.owner[b] != static_cast<std::int32_t>(owner)) continue;
            const Vec3d gradient = static_cast<double>(boundary_pairs.slope[p]) *
                                   (new_position[i] - boundary.position[b]).head<3>().cast<double>();
            visit(i, b, Vec3d(push * static_cast<double>(boundary.volume[b]) * gradient));
        }
    }
}

} // namespace flotsam
