#include "sph/forces/skin_friction.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace flotsam {
namespace {

/// Of a sample, where samples are 0.7 d apart: blue noise covers a plane by 0.61 d^2 each.
double sample_area(const SkinFrictionSettings& settings)
{
    return settings.dimensions == 2 ? 0.7 * settings.spacing : 0.61 * settings.spacing * settings.spacing;
}

/// [Pa]
double stress(const SkinFrictionSettings& settings, double slip, double length)
{
    if (!(slip > 0.0)) return 0.0;
    return 0.5 * settings.rest_density * slip * slip * plate_friction(slip * length / settings.kinematic_viscosity);
}

/// What of the impulse `all` is not in `resolved` yet, 0 to 1; moments count by `length`.
double unresolved(const Wrench& all, const Wrench& resolved, double length)
{
    const double per_length_sq = 1.0 / (length * length);
    const double sq = all.linear.squaredNorm() + per_length_sq * all.angular.squaredNorm();
    if (!(sq > 0.0)) return 1.0;
    const double part = all.linear.dot(resolved.linear) + per_length_sq * all.angular.dot(resolved.angular);
    return std::clamp(1.0 - part / sq, 0.0, 1.0);
}

double plate_length(double area, const SkinFrictionSettings& settings)
{
    return settings.dimensions == 2 ? area : std::sqrt(area);
}

} // namespace

double plate_friction(double reynolds)
{
    constexpr double kTurbulent = 5e5;
    const double laminar = 1.328 / std::sqrt(reynolds);
    return reynolds < kTurbulent ? laminar : std::max(laminar, 0.074 / std::pow(reynolds, 0.2) - 1742.0 / reynolds);
}

SkinFriction::Sum& SkinFriction::Sum::operator+=(const Sum& other)
{
    impulse += other.impulse;
    slowed += other.slowed;
    inertia += other.inertia;
    return *this;
}

void SkinFriction::find_wet_samples(const FluidState& fluid, const BoundaryState& boundary, const Pairs& boundary_pairs,
                                    const Contacts& contacts, std::size_t walls, const Workers& workers)
{
    is_wet_.assign(boundary.size(), 0);
    wet_count_.assign(contacts.owners(), 0);
    const std::size_t first = contacts.start[walls];
    workers.for_each(contacts.particle.size() - first, [&](std::size_t k) {
        const std::size_t i = contacts.particle[first + k];
        if (!(fluid.pressure[i] > 0)) return;
        for (std::uint32_t p = boundary_pairs.start[i]; p < boundary_pairs.start[i + 1]; ++p)
            std::atomic_ref(is_wet_[boundary_pairs.index[p]]).store(1, std::memory_order_relaxed);
    });
    for (std::size_t b = 0; b < boundary.size(); ++b)
        wet_count_[static_cast<std::size_t>(boundary.owner[b])] += is_wet_[b];
}

double SkinFriction::wetted_area(std::size_t owner, const SkinFrictionSettings& settings) const
{
    return static_cast<double>(wet_count_[owner]) * sample_area(settings);
}

void SkinFriction::add(const SkinFrictionSettings& settings, double dt, const FluidState& fluid,
                       const BoundaryState& boundary, const Pairs& boundary_pairs, const Contacts& contacts,
                       std::size_t walls, std::span<const Vec3d> centers, std::span<const Twist> twists,
                       OwnerResponse respond, const Workers& workers, std::span<Vec4> velocity,
                       std::span<Wrench> owner_impulses)
{
    const std::size_t owners = contacts.owners();
    if (contacts.start[walls] == contacts.particle.size()) return; // no body touches water
    find_wet_samples(fluid, boundary, boundary_pairs, contacts, walls, workers);
    impulses_.resize(contacts.particle.size()); // with room for more, unlike assign
    std::fill(impulses_.begin(), impulses_.end(), Vec4(Vec4::Zero()));
    sums_.assign(owners, Sum{});
    offered_.assign(owners, Wrench{});
    answers_.assign(owners, Twist{});
    const double mass = fluid.particle_mass;
    for (std::size_t owner = walls; owner < owners; ++owner) {
        const std::size_t first = contacts.start[owner], rows = contacts.start[owner + 1] - first;
        const double area = wetted_area(owner, settings), length = plate_length(area, settings);
        if (!(area > 0.0)) continue;
        const double contact = workers.ordered_sum<double>(rows, weights_, [&](std::size_t r) {
            const bool counts = fluid.pressure[contacts.particle[first + r]] > 0;
            return counts ? static_cast<double>(contacts.row[first + r].head<3>().norm()) : 0.0;
        });
        if (!(contact > 0.0)) continue;
        sums_[owner] = workers.ordered_sum<Sum>(rows, scratch_, [&](std::size_t r) {
            const std::size_t i = contacts.particle[first + r];
            const Vec3d row = contacts.row[first + r].head<3>().cast<double>();
            const double weight = row.norm();
            if (!(fluid.pressure[i] > 0 && weight > 0.0)) return Sum{};
            const Vec3d arm = fluid.position[i].head<3>().cast<double>() - centers[owner];
            Vec3d slip = twists[owner].at(arm) - Vec3d(fluid.velocity[i].head<3>().cast<double>());
            slip -= row * (row.dot(slip) / (weight * weight));
            const double speed = slip.norm();
            const double rubbed = dt * area * weight / contact * stress(settings, speed, length);
            if (!(rubbed > 0.0)) return Sum{};
            const Vec3d impulse = std::min(rubbed / speed, 0.5 * mass) * slip; // on the particle
            impulses_[first + r].head<3>() = impulse.cast<Scalar>();
            return Sum{{-impulse, -arm.cross(impulse)}, impulse.dot(slip), impulse.squaredNorm() / mass};
        });
        offered_[owner] = sums_[owner].impulse;
    }
    respond(offered_, answers_);
    for (std::size_t owner = walls; owner < owners; ++owner) {
        const Sum& sum = sums_[owner];
        if (!(sum.slowed > 0.0)) continue;
        const Twist& answer = answers_[owner];
        const double inertia =
            sum.inertia + sum.impulse.linear.dot(answer.linear) + sum.impulse.angular.dot(answer.angular);
        const double length = plate_length(wetted_area(owner, settings), settings);
        const double share = std::min(unresolved(sum.impulse, owner_impulses[owner], length), sum.slowed / inertia);
        const Scalar change = static_cast<Scalar>(share / mass);
        // One row for each particle that touches the owner.
        const std::size_t first = contacts.start[owner], rows = contacts.start[owner + 1] - first;
        workers.for_each(
            rows, [&](std::size_t r) { velocity[contacts.particle[first + r]] += change * impulses_[first + r]; });
        owner_impulses[owner] += {share * sum.impulse.linear, share * sum.impulse.angular};
    }
}

} // namespace flotsam
