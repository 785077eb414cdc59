#include "flotsam/core/contracts.hpp"
#include "world/fluid_world_impl.hpp"
#include "world/usable_mesh.hpp"

#include <algorithm>
#include <stdexcept>

namespace flotsam {
namespace {

/// Keeps the elements whose flag is 0, in order.
template <class T>
void keep_others(std::vector<T>& values, std::span<const char> is_dropped)
{
    std::size_t kept = 0;
    for (std::size_t k = 0; k < values.size(); ++k)
        if (is_dropped[k] == 0) values[kept++] = values[k];
    values.resize(kept);
}

} // namespace

int FluidWorld::add_body(const TriangleMesh& closed_about_center_of_mass)
{
    impl_->require_no_step();
    require_solid(closed_about_center_of_mass, "a body's mesh");
    BodySurface body;
    body.mesh = closed_about_center_of_mass;
    body.name = "body " + std::to_string(body_count());
    body.is_changed = impl_->prepared;
    impl_->bodies.push_back(std::move(body));
    return body_count() - 1;
}

void FluidWorld::remove_body(int number)
{
    impl_->require_no_step();
    BodySurface& body = impl_->body(number);
    body.mesh = {};
    body.query.reset();
    body.sheet.reset();
    body.last_pose.reset();
    body.is_changed = false;
    const std::size_t owner = impl_->walls.size() + static_cast<std::size_t>(number);
    if (owner < impl_->total.size()) impl_->total[owner] = {};
    if (!impl_->prepared) return;
    impl_->remove_samples(owner);
    impl_->films.forget(owner);
    if (owner < impl_->guard.surfaces()) impl_->guard.change(owner, {}, impl_->spacing(), impl_->workers);
}

void FluidWorld::reshape_body(int number, const TriangleMesh& closed_about_center_of_mass)
{
    impl_->require_no_step();
    require_solid(closed_about_center_of_mass, "a body's mesh");
    BodySurface& body = impl_->body(number);
    body.mesh = closed_about_center_of_mass;
    body.is_changed = impl_->prepared;
}

void FluidWorld::Impl::require_no_step() const
{
    if (is_stepping) throw std::logic_error("bodies must not be added, removed or reshaped while a step runs");
}

BodySurface& FluidWorld::Impl::body(int number)
{
    require(number >= 0 && number < static_cast<int>(bodies.size()) &&
                !bodies[static_cast<std::size_t>(number)].mesh.empty(),
            "no body has this number", number);
    return bodies[static_cast<std::size_t>(number)];
}

void FluidWorld::Impl::remove_samples(std::size_t owner)
{
    std::vector<char> is_dropped(boundary.size());
    for (std::size_t b = 0; b < boundary.size(); ++b)
        is_dropped[b] = boundary.owner[b] == static_cast<std::int32_t>(owner) ? 1 : 0;
    keep_others(boundary.position, is_dropped);
    keep_others(boundary.volume, is_dropped);
    keep_others(boundary.velocity, is_dropped);
    keep_others(boundary.position_body, is_dropped);
    keep_others(boundary.owner, is_dropped);
    if (boundary.normal.empty()) return;
    keep_others(boundary.normal, is_dropped);
    keep_others(boundary.normal_body, is_dropped);
}

/// Bodies that were added or reshaped get their samples; water in the place of those and of bodies that were put
/// elsewhere makes room.
void FluidWorld::Impl::take_in_changes(StepReport& report)
{
    constexpr int kRelaxingRounds = 10;
    bool makes_room = false;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        BodySurface& body = bodies[k];
        if (body.is_changed) {
            body.query = std::make_unique<SurfaceQuery>(body.mesh);
            remove_samples(walls.size() + k);
            sample_body(k);
            films.forget(walls.size() + k);
            guard.change(walls.size() + k, {body.query.get(), false, true}, spacing(), workers);
        }
        if (body.is_changed || has_jumped(k)) {
            make_room(k, report);
            makes_room = true;
        }
        body.is_changed = false;
    }
    if (!makes_room) return;
    place_body_samples();
    relax(kRelaxingRounds);
}

/// Whether the body is further from where the last step took it than an impact or a joint explains.
bool FluidWorld::Impl::has_jumped(std::size_t k) const
{
    const BodySurface& body = bodies[k];
    if (!body.query || !body.last_pose) return false;
    const Pose &then = *body.last_pose, &now = states[k].pose;
    const double moved_by =
        (now.position - then.position).norm() + body.reach() * now.orientation.angularDistance(then.orientation);
    return moved_by > spacing() + 2.0 * last_dt * max_speed;
}

/// Moves the water out of the body: to the same place in where the body was, if there is room; else it is removed.
void FluidWorld::Impl::make_room(std::size_t k, StepReport& report)
{
    std::vector<std::uint32_t> removed;
    const std::optional<Pose> then = bodies[k].last_pose;
    for (std::size_t i = 0; i < fluid.size(); ++i) {
        const Vec3d at = fluid.position[i].head<3>().cast<double>();
        if (!in_body(k, states[k].pose, at)) continue;
        fluid.pressure[i] = 0;
        const Vec3d to = then ? then->to_world(states[k].pose.to_body(at)) : at;
        if (in_solid(to))
            removed.push_back(static_cast<std::uint32_t>(i));
        else
            fluid.position[i].head<3>() = to.cast<Scalar>();
    }
    remove_particles(removed, report);
}

void FluidWorld::Impl::remove_particles(std::span<const std::uint32_t> rising, StepReport& report)
{
    if (rising.empty()) return;
    std::vector<char> is_dropped(fluid.size(), 0);
    for (const std::uint32_t i : rising) {
        is_dropped[i] = 1;
        report.removed_momentum += fluid.particle_mass * fluid.velocity[i].head<3>().cast<double>();
    }
    report.removed_particles += static_cast<int>(rising.size());
    keep_others(fluid.position, is_dropped);
    keep_others(fluid.velocity, is_dropped);
    keep_others(fluid.density, is_dropped);
    keep_others(fluid.pressure, is_dropped);
    keep_others(fluid.id, is_dropped);
}

} // namespace flotsam
