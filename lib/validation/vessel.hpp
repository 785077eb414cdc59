#pragma once

#include "validation/case.hpp"

namespace flotsam::validation {

/// Drafts of an open boat of sheet metal that floats on her hollow.
void run_vessel(const ValidationOptions& options, ValidationResult& result);

} // namespace flotsam::validation
