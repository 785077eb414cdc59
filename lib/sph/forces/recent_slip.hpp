#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/fluid_state.hpp"
#include "sph/contacts.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// How much each body moves against the water that touches it, of late: its packing is strained then, and else at rest.
///
/// The mean velocity of a body against the water at its surface, and its mean rotation times the reach of the surface,
/// each without its own mean over the last 10 sqrt(d / g), so that a steady current along the body does not count; the
/// largest of the last 10 sqrt(d / g). Counted from 0.03 sqrt(g d), which water at rest stays below, to 0.1 sqrt(g d),
/// where a body let go under water is after a tenth of a spacing.
class RecentSlip {
  public:
    /// Goes on by dt [s]. `contacts`: of the owners, walls first; `walls`: how many of them are; `centers` [m] and
    /// `twists`, at the start of the step, of the owners. Without gravity all bodies that water touches move.
    void update(double dt, double spacing, double gravity, const FluidState& fluid, const Contacts& contacts,
                std::size_t walls, std::span<const Vec3d> centers, std::span<const Twist> twists,
                const Workers& workers);

    /// Of each owner, 0 (at rest, and all walls) to 1.
    [[nodiscard]] std::span<const Scalar> shares() const { return shares_; }

  private:
    struct Slip {
        Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero(); ///< means over the last while [m/s], [rad/s]
        double recent = 0.0;                                   ///< the largest, over sqrt(g d)
    };
    struct Sum {
        Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();
        double weight = 0.0, inertia = 0.0;
        Sum& operator+=(const Sum& other);
    };
    std::vector<Slip> slips_; ///< of each body
    std::vector<Scalar> shares_;
    std::vector<Sum> scratch_;
};

} // namespace flotsam
