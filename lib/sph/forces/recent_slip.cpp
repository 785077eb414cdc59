#include "sph/forces/recent_slip.hpp"

#include "core/smooth_step.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

constexpr double kMemory = 10.0;               ///< over sqrt(d / g)
constexpr double kStill = 0.03, kMoves = 0.10; ///< over sqrt(g d)

} // namespace

RecentSlip::Sum& RecentSlip::Sum::operator+=(const Sum& other)
{
    linear += other.linear;
    angular += other.angular;
    weight += other.weight;
    inertia += other.inertia;
    return *this;
}

void RecentSlip::update(double dt, double spacing, double gravity, const FluidState& fluid, const Contacts& contacts,
                        std::size_t walls, std::span<const Vec3d> centers, std::span<const Twist> twists,
                        const Workers& workers)
{
    shares_.assign(contacts.owners(), Scalar(0));
    slips_.resize(contacts.owners() - walls);
    const double past = gravity > 0.0 ? dt / (kMemory * std::sqrt(spacing / gravity)) : 0.0;
    for (std::size_t owner = walls; owner < contacts.owners(); ++owner) {
        const std::size_t first = contacts.start[owner], rows = contacts.start[owner + 1] - first;
        if (!(gravity > 0.0)) {
            shares_[owner] = rows > 0 ? Scalar(1) : Scalar(0);
            continue;
        }
        Slip& slip = slips_[owner - walls];
        slip.recent *= std::exp(-past);
        const Sum sum = workers.ordered_sum<Sum>(rows, scratch_, [&](std::size_t r) {
            const std::size_t i = contacts.particle[first + r];
            const double weight = static_cast<double>(contacts.row[first + r].head<3>().norm());
            const Vec3d arm = fluid.position[i].head<3>().cast<double>() - centers[owner];
            const Vec3d against = weight * (twists[owner].at(arm) - Vec3d(fluid.velocity[i].head<3>().cast<double>()));
            return Sum{against, arm.cross(against), weight, weight * arm.squaredNorm()};
        });
        if (sum.weight > 0.0 && sum.inertia > 0.0) {
            const Vec3d linear = sum.linear / sum.weight, angular = sum.angular / sum.inertia;
            const double reach = std::sqrt(sum.inertia / sum.weight);
            const double speed = (linear - slip.linear).norm() + reach * (angular - slip.angular).norm();
            slip.recent = std::max(slip.recent, speed / std::sqrt(gravity * spacing));
            slip.linear += std::min(1.0, past) * (linear - slip.linear);
            slip.angular += std::min(1.0, past) * (angular - slip.angular);
        }
        shares_[owner] = static_cast<Scalar>(smooth_step((slip.recent - kStill) / (kMoves - kStill)));
    }
}

} // namespace flotsam
