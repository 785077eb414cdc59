#include "bullet/mobility.hpp"

#include "bullet/convert.hpp"

#include <limits>

namespace flotsam {

namespace {

/// Of the trace; less is rounding of an axis about which the body never turns.
constexpr double kSmallest = 10.0 * std::numeric_limits<btScalar>::epsilon();

/// Takes axis k out of an inverse inertia by the impulse about k that keeps the body from turning about it.
void lock(int k, Mobility& mobility)
{
    const double own = mobility.angular(k, k);
    if (own > kSmallest * mobility.angular.trace()) {
        const Vec3d per_turn = mobility.angular.col(k) / own;
        mobility.held -= (per_turn * mobility.held.row(k)).eval();
        mobility.angular -= (per_turn * mobility.angular.row(k)).eval();
    }
    mobility.angular.row(k).setZero();
    mobility.angular.col(k).setZero();
    mobility.held.row(k).setZero();
}

} // namespace

Mobility mobility_of(const btRigidBody& body)
{
    Mobility mobility;
    mobility.linear = static_cast<double>(body.getInvMass()) * from_bullet(body.getLinearFactor()).cwiseMax(0.0);

    const Mat3d inv_inertia = from_bullet(body.getInvInertiaTensorWorld());
    mobility.angular = 0.5 * (inv_inertia + inv_inertia.transpose());
    const Vec3d factor = from_bullet(body.getAngularFactor()).cwiseMax(0.0);
    for (int k = 0; k < 3; ++k)
        if (!(factor[k] > 0.0)) lock(k, mobility);
    const Vec3d root = factor.cwiseSqrt();
    mobility.angular = root.asDiagonal() * mobility.angular * root.asDiagonal();
    return mobility;
}

} // namespace flotsam
