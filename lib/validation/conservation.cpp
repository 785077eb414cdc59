// What must not be lost.
#include "validation/case.hpp"

#include <array>
#include <cmath>
#include <sstream>

namespace flotsam::validation {
namespace {

/// A cube dropped into a tank: how far the ledger's balances are from closing, as parts of what was exchanged.
void run_ledger(const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kEdge = 0.12, kResolution = 8.0;
    TankScene tank{.dimensions = 3,
                   .spacing = kEdge / kResolution,
                   .width = 3.0 * kEdge,
                   .depth = 3.0 * kEdge,
                   .level = 2.0 * kEdge,
                   .height = 6.0 * kEdge,
                   .duration = options.quick ? 0.6 : 2.0};
    std::ostringstream text;
    text << R"({"name": "cube", "shape": {"box": [0.12, 0.12, 0.12]}, "density": 400, "rotation_deg": [20, 10, 0],
             "position": [)"
         << 0.5 * tank.width << ", " << 0.5 * tank.depth << ", " << tank.level + kEdge << "]}";
    tank.bodies = text.str();
    const RunReport report = run_unrecorded(tank.text(), options);
    const LedgerErrors errors = report.ledger.errors();
    const LedgerScales scales = report.ledger.scales();
    const auto check = [&](const char* quantity, double value, double tolerance) {
        result.checks.push_back({quantity, "-", kResolution, value, 0.0, tolerance, std::nullopt,
                                 report.simulated_seconds, report.wall_seconds});
    };
    check("error of momentum / exchanged", errors.momentum.norm() / scales.momentum, 1e-5);
    check("error of angular momentum / exchanged", errors.angular_momentum.norm() / scales.angular_momentum, 1e-5);
    check("error of energy / exchanged", std::abs(errors.energy) / scales.energy, 1e-5);
    check("particles leaked", report.leaked, 0.0);
    check("steps not converged", static_cast<double>(report.unconverged_steps), 0.0);
}

constexpr std::array kCases = {
    Case{"ledger", "conservation", "Balances of a cube dropped into a tank", 20.0, 60.0, run_ledger},
};

} // namespace

std::span<const Case> conservation_cases()
{
    return kCases;
}

} // namespace flotsam::validation
