#include "world/fluid_world_impl.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/hydrostatics.hpp"

namespace flotsam {
namespace {

/// A height above which no part of the mesh lies.
double above(const TriangleMesh& mesh, const Pose& pose)
{
    return lowest_point(mesh, pose) + 1.001 * bounds(mesh).size().norm();
}

} // namespace

/// Whether water touched this owner in the last step.
bool FluidWorld::Impl::is_touched(std::size_t owner) const
{
    return last_dt > 0.0 && owner < contacts.owners() && contacts.start[owner] < contacts.start[owner + 1];
}

/// Whether that step's pushes can still be read: not once a body was removed, until the next step.
bool FluidWorld::Impl::has_pushes(std::size_t owner) const
{
    return is_touched(owner) && paired_samples == boundary.size();
}

/// Of the last step, about the owner's centre: of a body that of its mass, of a wall the world's origin.
ByCause<Wrench> FluidWorld::Impl::wrenches(std::size_t owner) const
{
    const bool is_removed = owner >= walls.size() && bodies[owner - walls.size()].mesh.empty();
    if (!(last_dt > 0.0) || owner >= guarded.size() || is_removed) return {};
    const double rate = 1.0 / last_dt;
    return {(pushed[owner] + filmed[owner]) * rate, rubbed[owner] * rate, relieved[owner] * rate,
            guarded[owner] * rate};
}

Wrench FluidWorld::Impl::hydrostatic(std::size_t body, std::optional<double> level) const
{
    const TriangleMesh& mesh = bodies[body].mesh;
    if (mesh.empty() || !is_touched(walls.size() + body) || settings.gravity.isZero(0.0)) return {};
    const Pose& pose = states[body].pose;
    const double height = level ? *level : above(mesh, pose);
    const Submerged part =
        settings.dimensions == 2 ? submerged_section(mesh, pose, height) : submerged_part(mesh, pose, height);
    const Wrench lift{-settings.rest_density * part.volume * settings.gravity, Vec3d::Zero()};
    return lift.seen_at(part.center_of_buoyancy - pose.position);
}

FluidForces FluidWorld::fluid_forces(int body) const
{
    require(body >= 0 && body < body_count(), "no body has this number", body);
    const std::size_t k = static_cast<std::size_t>(body);
    const ByCause<Wrench> by_cause = impl_->wrenches(impl_->walls.size() + k);
    const bool has_level = is_level(impl_->settings.gravity) && impl_->is_touched(impl_->walls.size() + k);
    FluidForces forces;
    forces.hydrostatic = impl_->hydrostatic(k, has_level ? waterlines(impl_->states)[k] : std::nullopt);
    forces.dynamic = by_cause.pressure - forces.hydrostatic;
    forces.viscous = by_cause.viscous;
    forces.packing = by_cause.packing;
    forces.guard = by_cause.guard;
    return forces;
}

FluidForces FluidWorld::fluid_forces(int body, const Vec3d& about) const
{
    require(about.allFinite(), "a point must be finite [m]");
    FluidForces forces = fluid_forces(body);
    const std::size_t owner = impl_->walls.size() + static_cast<std::size_t>(body);
    if (owner >= impl_->centers.size()) return forces; // before the first step
    const Vec3d arm = impl_->centers[owner] - about;
    for (Wrench* part : {&forces.hydrostatic, &forces.dynamic, &forces.viscous, &forces.packing, &forces.guard})
        *part = part->seen_at(arm);
    return forces;
}

ByCause<Wrench> FluidWorld::wall_wrench(int wall) const
{
    require(wall >= 0 && wall < wall_count(), "no wall has this number", wall);
    return impl_->wrenches(static_cast<std::size_t>(wall));
}

std::vector<SampleForce> FluidWorld::sample_forces(int body) const
{
    require(body >= 0 && body < body_count(), "no body has this number", body);
    const Impl& world = *impl_;
    const std::int32_t owner = static_cast<std::int32_t>(world.walls.size()) + body;
    std::vector<SampleForce> samples;
    std::vector<std::size_t> place(world.boundary.size());
    for (std::size_t b = 0; b < world.boundary.size(); ++b) {
        if (world.boundary.owner[b] != owner) continue;
        place[b] = samples.size();
        samples.push_back({world.boundary.position[b].head<3>().cast<double>(), Vec3d::Zero()});
    }
    if (!world.has_pushes(static_cast<std::size_t>(owner))) return samples;
    world.visit_pushes(static_cast<std::size_t>(owner),
                       [&](std::uint32_t, std::uint32_t b, const Vec3d& force) { samples[place[b]].force += force; });
    return samples;
}

} // namespace flotsam
