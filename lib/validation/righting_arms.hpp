#pragma once

#include "flotsam/validation/validation.hpp"

namespace flotsam::validation {

/// Boxes held at half their height in the water, turned: the arm is the water's torque over the displaced weight.
void run_righting_arm(const ValidationOptions& options, ValidationResult& result);

/// A Wigley hull held at a heel, at the height at which it floats: righting arm and upward force.
void run_wigley_heel(const ValidationOptions& options, ValidationResult& result);

} // namespace flotsam::validation
