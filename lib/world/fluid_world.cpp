#include "flotsam/world/fluid_world.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/core/hash.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/geometry/volume_samples.hpp"
#include "world/fluid_world_impl.hpp"
#include "world/usable_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>

namespace flotsam {
namespace {

const FluidWorldSettings& checked(const FluidWorldSettings& s)
{
    const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    require(s.dimensions == 2 || s.dimensions == 3, "dimensions must be 2 or 3", s.dimensions);
    require(positive(s.particle_spacing), "particle_spacing must be > 0 [m]", s.particle_spacing);
    require(s.gravity.allFinite(), "gravity must be finite [m/s^2]");
    require(positive(s.rest_density), "rest_density must be > 0 [kg/m^3]", s.rest_density);
    require(s.kinematic_viscosity >= 0.0 && std::isfinite(s.kinematic_viscosity),
            "kinematic_viscosity must be >= 0 [m^2/s]", s.kinematic_viscosity);
    require(s.packing_relief >= 0.0 && s.packing_relief <= 1.0, "packing_relief must lie in [0, 1]", s.packing_relief);
    require(s.dissipation >= 0.0 && std::isfinite(s.dissipation), "dissipation must be >= 0", s.dissipation);
    require(positive(s.max_time_step), "max_time_step must be > 0 [s]", s.max_time_step);
    require(s.cfl > 0.0 && s.cfl <= 1.0, "cfl must be in (0, 1]", s.cfl);
    require(positive(s.pressure.tolerance), "pressure.tolerance must be > 0", s.pressure.tolerance);
    require(positive(s.pressure.velocity_tolerance), "pressure.velocity_tolerance must be > 0",
            s.pressure.velocity_tolerance);
    require(s.pressure.max_iterations >= 1, "pressure.max_iterations must be >= 1", s.pressure.max_iterations);
    return s;
}

} // namespace

FluidWorld::Impl::Impl(const FluidWorldSettings& s)
    : settings(checked(s)), workers(s.threads), kernel(s.kernel, s.particle_spacing, s.dimensions)
{
}

FluidWorld::FluidWorld(const FluidWorldSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
FluidWorld::~FluidWorld() = default;
FluidWorld::FluidWorld(FluidWorld&&) noexcept = default;
FluidWorld& FluidWorld::operator=(FluidWorld&&) noexcept = default;

void FluidWorld::Impl::require_still_if_at_rest(const Vec3d& velocity) const
{
    require(settings.start == FluidWorldSettings::Start::as_given || velocity.isZero(0.0),
            "water that starts at rest must have a velocity of 0 [m/s]", velocity.norm());
}

void FluidWorld::add_block(const Aabb& block, const Vec3d& velocity)
{
    require(!impl_->prepared, "water must be added before the first step");
    require(!block.empty(), "a block's min must not exceed its max [m]");
    require(velocity.allFinite(), "a block's velocity must be finite [m/s]");
    impl_->require_still_if_at_rest(velocity);
    const bool is_flat = impl_->settings.dimensions == 2;
    const auto covers = [block, is_flat](const Vec3d& p) {
        return block.contains(is_flat ? Vec3d(p.x(), block.center().y(), p.z()) : p);
    };
    impl_->seeds.push_back({fill_box(block, impl_->spacing(), impl_->settings.dimensions), velocity, true, covers});
}

void FluidWorld::add_fluid_mesh(const TriangleMesh& closed, const Vec3d& velocity)
{
    require(!impl_->prepared, "water must be added before the first step");
    require(velocity.allFinite(), "the velocity of a mesh's water must be finite [m/s]");
    impl_->require_still_if_at_rest(velocity);
    require_solid(closed, "a mesh of water");
    const auto query = std::make_shared<SurfaceQuery>(closed);
    const auto covers = [query](const Vec3d& p) { return query->bounds().contains(p) && query->inside(p); };
    impl_->seeds.push_back({fill_mesh(*query, impl_->spacing(), impl_->settings.dimensions), velocity, true, covers});
}

void FluidWorld::add_particles(std::span<const Vec3d> positions, const Vec3d& velocity)
{
    require(!impl_->prepared, "water must be added before the first step");
    for (const Vec3d& p : positions) require(p.allFinite(), "particle positions must be finite [m]");
    require(velocity.allFinite(), "the velocity of particles must be finite [m/s]");
    impl_->require_still_if_at_rest(velocity);
    impl_->seeds.push_back({{positions.begin(), positions.end()}, velocity, false, {}});
}

int FluidWorld::add_wall(const TriangleMesh& mesh, WallSide side)
{
    require(!impl_->prepared, "walls must be added before the first step");
    require_surface(mesh, "a wall's mesh");
    Wall wall;
    wall.mesh = mesh;
    wall.side = side;
    wall.name = "wall " + std::to_string(wall_count());
    impl_->walls.push_back(std::move(wall));
    return wall_count() - 1;
}

int FluidWorld::add_box_wall(const Aabb& given, const std::vector<std::string>& open)
{
    Aabb box = given;
    if (impl_->settings.dimensions == 2) { // a metre of width around the plane
        box.min.y() = -0.5;
        box.max.y() = 0.5;
    }
    require((box.size().array() > 0.0).all(), "a box wall's min must be below its max [m]");
    const int number = add_wall(container_box(box, open), WallSide::inside);
    Wall& wall = impl_->walls.back();
    wall.box = box;
    wall.open = open_sides(open);
    return number;
}

void FluidWorld::name_wall(int wall, const std::string& name)
{
    require(wall >= 0 && wall < wall_count(), "no wall has this number", wall);
    require(!impl_->prepared, "walls must be named before the first step");
    impl_->walls[static_cast<std::size_t>(wall)].name = name;
}

void FluidWorld::name_body(int body, const std::string& name)
{
    impl_->body(body).name = name;
}

void FluidWorld::prepare(Bodies& bodies, const std::function<void(const SettleProgress&)>& on_round)
{
    impl_->prepare(bodies, on_round);
}

/// Pressure forces are explicit in the direction that they act in: a packing under pressure p answers sideways with
/// frequencies of about sqrt(p / rho) / d, and comes apart where they are not resolved. Still tanks of 40 layers hold
/// together at 0.5 and come apart at 0.6, in 2-D and 3-D, with either source.
double FluidWorld::Impl::pressure_time_step() const
{
    constexpr double kPressureStep = 0.45;
    return kPressureStep * spacing() / std::sqrt(max_pressure / settings.rest_density);
}

double FluidWorld::allowed_time_step() const
{
    const FluidWorldSettings& s = impl_->settings;
    double dt = s.max_time_step;
    // Speed at the end of a step that gravity accelerates all the way: v + g dt.
    const double reach = s.cfl * s.particle_spacing;
    const double g = s.gravity.norm();
    const double v = impl_->max_speed;
    if (v > 0.0 || g > 0.0) dt = std::min(dt, 2.0 * reach / (v + std::sqrt(v * v + 4.0 * g * reach)));
    if (impl_->max_pressure > 0.0) dt = std::min(dt, impl_->pressure_time_step());
    if (s.kinematic_viscosity > 0.0) {
        dt =
            std::min(dt, 0.125 * s.particle_spacing * s.particle_spacing / s.kinematic_viscosity); // Morris et al. 1997
    }
    return dt;
}

StepReport FluidWorld::step(double dt, Bodies& bodies)
{
    require(dt > 0.0 && std::isfinite(dt), "dt must be > 0 [s]", dt);
    impl_->prepare(bodies);
    impl_->require_no_step();
    impl_->is_stepping = true;
    try {
        StepReport report = impl_->step(dt, bodies);
        impl_->is_stepping = false;
        return report;
    } catch (...) {
        impl_->is_stepping = false;
        throw;
    }
}

const FluidWorldSettings& FluidWorld::settings() const
{
    return impl_->settings;
}

double FluidWorld::time() const
{
    return impl_->time;
}

const FluidState& FluidWorld::fluid() const
{
    return impl_->fluid;
}

const BoundaryState& FluidWorld::boundary() const
{
    return impl_->boundary;
}

int FluidWorld::wall_count() const
{
    return static_cast<int>(impl_->walls.size());
}

int FluidWorld::body_count() const
{
    return static_cast<int>(impl_->bodies.size());
}

const TriangleMesh& FluidWorld::wall_mesh(int wall) const
{
    require(wall >= 0 && wall < wall_count(), "no wall has this number", wall);
    return impl_->walls[static_cast<std::size_t>(wall)].mesh;
}

Wrench FluidWorld::fluid_wrench(int body) const
{
    require(body >= 0 && body < body_count(), "no body has this number", body);
    const std::size_t owner = impl_->walls.size() + static_cast<std::size_t>(body);
    if (!(impl_->last_dt > 0.0) || owner >= impl_->total.size()) return {}; // added since the last step
    return impl_->total[owner] * (1.0 / impl_->last_dt);
}

Vec3d FluidWorld::wall_force(int wall) const
{
    require(wall >= 0 && wall < wall_count(), "no wall has this number", wall);
    if (!(impl_->last_dt > 0.0)) return Vec3d::Zero();
    return impl_->total[static_cast<std::size_t>(wall)].linear / impl_->last_dt;
}

const Ledger& FluidWorld::ledger() const
{
    return impl_->ledger;
}

const std::vector<std::string>& FluidWorld::notes() const
{
    return impl_->notes;
}

std::uint64_t FluidWorld::state_hash() const
{
    const FluidState& fluid = impl_->fluid;
    std::vector<std::uint32_t> slot(fluid.size());
    std::iota(slot.begin(), slot.end(), 0u);
    std::sort(slot.begin(), slot.end(), [&](std::uint32_t a, std::uint32_t b) { return fluid.id[a] < fluid.id[b]; });
    StateHash hash;
    hash.add_bytes(&impl_->time, sizeof impl_->time);
    for (const std::uint32_t i : slot) {
        hash.add_bytes(fluid.position[i].data(), 3 * sizeof(Scalar));
        hash.add_bytes(fluid.velocity[i].data(), 3 * sizeof(Scalar));
    }
    return hash.value();
}

} // namespace flotsam
