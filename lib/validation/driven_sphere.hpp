#pragma once

#include "flotsam/validation/validation.hpp"

namespace flotsam::validation {

void run_added_mass(const ValidationOptions& options, ValidationResult& result);

} // namespace flotsam::validation
