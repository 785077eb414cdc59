#include "world/fluid_world_impl.hpp"

#include <algorithm>
#include <limits>

namespace flotsam {
namespace {

/// Depths of a mesh in the world, along gravity of length 1 [m].
void widen(const TriangleMesh& mesh, const Pose& pose, const Vec3d& down, double& shallowest, double& deepest)
{
    for (const Vec3d& vertex : mesh.vertices) {
        const double depth = down.dot(pose.to_world(vertex));
        shallowest = std::min(shallowest, depth);
        deepest = std::max(deepest, depth);
    }
}

} // namespace

/// Water that left over an open side falls for ever: it would shrink the time step and blow up the grid of the
/// neighbour search. Once it is below all that was there at the start, by as much as all that is high, nothing can
/// catch it.
void FluidWorld::Impl::find_deepest_catch()
{
    deepest_catch = std::numeric_limits<double>::infinity();
    if (owners() == 0 || !(settings.gravity.norm() > 0.0)) return;
    const Vec3d down = settings.gravity.normalized();
    double shallowest = std::numeric_limits<double>::infinity(), deepest = -shallowest;
    for (const Wall& wall : walls) widen(wall.mesh, Pose(), down, shallowest, deepest);
    for (std::size_t k = 0; k < bodies.size(); ++k) widen(bodies[k].mesh, states[k].pose, down, shallowest, deepest);
    for (const Vec4& p : fluid.position) {
        shallowest = std::min(shallowest, down.dot(p.head<3>().cast<double>()));
    }
    deepest_catch = deepest + (deepest - shallowest);
}

void FluidWorld::Impl::remove_fallen(StepReport& report)
{
    if (fluid.size() == 0 || deepest_catch == std::numeric_limits<double>::infinity()) return;
    const Vec3d down = settings.gravity.normalized();
    // Bodies that were put or driven lower catch water there; those that fall themselves do not.
    double limit = deepest_catch;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        if (!bodies[k].query || states[k].responds) continue;
        limit = std::max(limit, down.dot(states[k].pose.position) + bodies[k].reach());
    }
    const auto depth = [&](std::size_t i) { return down.dot(fluid.position[i].head<3>().cast<double>()); };
    const double deepest =
        workers.ordered_sum<MaxOf>(fluid.size(), max_scratch, [&](std::size_t i) { return MaxOf{depth(i) - limit}; })
            .value;
    if (!(deepest > 0.0)) return;
    std::vector<std::uint32_t> fallen;
    for (std::size_t i = 0; i < fluid.size(); ++i)
        if (depth(i) > limit) fallen.push_back(static_cast<std::uint32_t>(i));
    report.fallen_particles = static_cast<int>(fallen.size());
    remove_particles(fallen, report);
}

} // namespace flotsam
