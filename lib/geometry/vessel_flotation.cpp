#include "flotsam/geometry/vessel_flotation.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/flotation_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flotsam {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStep = 5.0 * kDegree, kFound = 1e-4 * kDegree; ///< of the search for the angle of flooding

/// The vessel of one body, turned about world x.
class HeeledVessel {
  public:
    HeeledVessel(const FloatingBody& body, const Quatd& upright)
        : solver_(body), upright_(upright), hollows_(solver_.hollows(upright))
    {
    }

    [[nodiscard]] std::optional<RightingArm> arm(double heel) const
    {
        const auto dry = solver_.dry_at(turned_by_heel(heel, upright_), hollows_);
        if (!dry) return std::nullopt;
        return righting_arm(solver_, *dry, heel);
    }

    /// Between upright and `last` [rad].
    [[nodiscard]] std::optional<double> flooding_heel(double last) const
    {
        double dry = 0.0;
        while (std::abs(dry) < std::abs(last)) {
            const double next = std::abs(last - dry) < kStep ? last : dry + std::copysign(kStep, last);
            if (!arm(next)) return between(dry, next);
            dry = next;
        }
        return std::nullopt;
    }

  private:
    [[nodiscard]] double between(double dry, double flooded) const
    {
        while (std::abs(flooded - dry) > kFound) {
            const double middle = 0.5 * (dry + flooded);
            (arm(middle) ? dry : flooded) = middle;
        }
        return dry;
    }

    FlotationSolver solver_;
    Quatd upright_;
    std::vector<char> hollows_;
};

} // namespace

std::optional<Flotation> vessel_flotation(const FloatingBody& body, const Quatd& orientation)
{
    const FlotationSolver solver(body);
    const auto dry = solver.dry_at(orientation);
    if (!dry) return std::nullopt;
    return solver.flotation(*dry);
}

VesselArms vessel_righting_arms(const FloatingBody& body, const Quatd& upright, std::span<const double> heel_angles)
{
    const HeeledVessel vessel(body, upright);
    require(vessel.arm(0.0).has_value(), "a vessel with righting arms must float upright");
    double lowest = 0.0, highest = 0.0;
    for (const double heel : heel_angles) {
        require(std::isfinite(heel), "heel angles must be finite [rad]", heel);
        lowest = std::min(lowest, heel);
        highest = std::max(highest, heel);
    }
    VesselArms result;
    result.flooding_heel = {vessel.flooding_heel(lowest), vessel.flooding_heel(highest)};
    for (const double heel : heel_angles) {
        if (heel < result.flooding_heel[0].value_or(lowest) || heel > result.flooding_heel[1].value_or(highest))
            continue;
        if (const auto arm = vessel.arm(heel)) result.arms.push_back(*arm);
    }
    return result;
}

} // namespace flotsam
