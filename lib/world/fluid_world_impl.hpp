#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/geometry/surface_query.hpp"
#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "sph/contacts.hpp"
#include "sph/forces/viscosity.hpp"
#include "sph/pressure/complementarity_solver.hpp"
#include "sph/pressure/pressure_system.hpp"
#include "world/wall_guard.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <string>

namespace flotsam {

/// A wall: a fixed surface with water on one side (or both).
struct Wall {
    TriangleMesh mesh;
    std::string name; ///< in notes
    WallSide side = WallSide::automatic;
    std::optional<Aabb> box;       ///< of a box wall
    std::array<bool, 6> open = {}; ///< of a box wall: -x +x -y +y -z +z
    std::unique_ptr<SurfaceQuery> query;
};

/// A body's surface about its centre of mass.
struct BodySurface {
    TriangleMesh mesh;
    std::string name; ///< in notes
    std::unique_ptr<SurfaceQuery> query;
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

/// Sum of vectors that starts at zero, for ordered_sum.
struct Sum3 {
    Vec3d value = Vec3d::Zero();
    Sum3& operator+=(const Sum3& other)
    {
        value += other.value;
        return *this;
    }
};

struct FluidWorld::Impl {
    explicit Impl(const FluidWorldSettings& settings);

    FluidWorldSettings settings;
    Workers workers;
    Kernel kernel;
    double time = 0.0;
    double max_pressure = 0.0; ///< of the last step; before it the hydrostatic one [Pa]
    double max_speed = 0.0;    ///< of fluid and bodies [m/s]
    bool prepared = false;
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
    NeighbourSearch search, boundary_search;
    Pairs fluid_pairs, boundary_pairs;
    ContactBuilder contact_builder;
    Contacts contacts;
    Viscosity viscosity;
    RelaxedJacobi relaxed_jacobi;
    Mprgp mprgp;
    PressureOperator pressure_operator;
    WallGuard guard;
    std::vector<BodyState> states;
    std::vector<Vec3d> centers; ///< of each owner
    std::vector<Twist> twists;  ///< of each owner, predicted
    std::vector<Wrench> pushed; ///< pressure impulses of each owner [N s]
    std::vector<Wrench> total;  ///< of each owner over the last step [N s]
    std::vector<Vec4> predicted, change, shift, new_position;
    std::vector<Scalar> multiplier, shift_multiplier, source, diagonal, shift_diagonal;
    std::vector<Eigen::Matrix<double, 6, 6>> mobility;
    std::vector<Vec4> sort_vec4;
    std::vector<Scalar> sort_scalar;
    std::vector<std::uint32_t> sort_id;
    std::vector<double> sums;
    std::vector<MaxOf> max_scratch;
    std::vector<Sum3> sum3_scratch;
    std::vector<Wrench> unit;
    std::vector<Twist> answer;
    std::vector<GuardedMotion> motion;
    std::vector<Wrench> guarded;
    std::vector<Vec4> relax_velocity;
    double last_dt = 0.0;
    int failed_shifts = 0;       ///< in a row
    int steps_without_shift = 0; ///< still to come

    [[nodiscard]] std::size_t owners() const { return walls.size() + bodies.size(); }
    [[nodiscard]] double spacing() const { return settings.particle_spacing; }
    [[nodiscard]] double support() const { return static_cast<double>(kernel.support()); }

    // readings.cpp
    enum class Readable { any, free, bulk };
    [[nodiscard]] Readable readable(std::size_t i) const;
    [[nodiscard]] double gauge_pressure(std::size_t i) const;
    [[nodiscard]] bool line_passes_body(std::span<const BodyState> at, double x, double y, double away) const;
    [[nodiscard]] bool touches_body(std::span<const BodyState> at, const Vec3d& point, double away) const;

    // prepare.cpp
    void prepare(Bodies& port);
    void choose_wall_sides();
    void seed_where_dry(FluidSeed seed);
    void cut_and_place_fluid();
    void sample_surfaces();
    void relax();
    void guard_relaxation();
    [[nodiscard]] bool in_solid(const Vec3d& point) const;

    // step.cpp
    StepReport step(double dt, Bodies& port);
    void read_bodies(double dt, Bodies& port);
    void place_body_samples();
    void find_neighbours();
    void sort_particles();
    void measure_density(StepReport& report);
    void add_forces(double dt, Bodies& port, StepReport& report);
    void solve_pressure(double dt, Bodies& port, StepReport& report);
    void respond(Bodies& port, std::span<const Wrench> impulses, std::span<Twist> answers) const;
    void build_mobility(Bodies& port);
    [[nodiscard]] SolveResult solve_shift();
    [[nodiscard]] double mean_length(std::span<const Vec4> vectors);
    [[nodiscard]] double part_of_cold_residual(double scale);
    [[nodiscard]] bool shift_if_possible(StepReport& report);
    void advance(double dt, Bodies& port, StepReport& report);
    void guard_walls(double dt, Bodies& port, StepReport& report);
    [[nodiscard]] ComplementaritySolver& solver();
};

} // namespace flotsam
