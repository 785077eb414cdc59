#pragma once

namespace flotsam {

/// How the pressure system is solved. Every field changes the result of a step.
struct PressureSettings {
    enum class Solver { iisph, mprgp, spg } solver = Solver::spg;
    enum class Source { split, published } source = Source::split;
    enum class Coupling { strong, weak } coupling = Coupling::strong;
    double tolerance = 1e-3;            ///< of the density: mean residual / rest density [-], > 0
    double velocity_tolerance = 1.5e-5; ///< of the velocity solve of the split, per step [-], > 0; at most 0.2 of the
                                        ///< residual that no pressure would leave, and in water that is nearly still
                                        ///< less (0.005 mean |v| dt / d, down to a twentieth)
    int max_iterations = 1000;          ///< of one solve; then it gives up: counted, not thrown
};

} // namespace flotsam
