#pragma once

#include "flotsam/validation/validation.hpp"

namespace flotsam::validation {

/// Boxes held at half their height in the water, turned: the arm is the water's torque over the displaced weight.
void run_righting_arm(const ValidationOptions& options, ValidationResult& result);

} // namespace flotsam::validation
