#pragma once

#include <string>
#include <vector>

namespace flotsam::simd {

/// Instruction sets that this processor has of those compiled, best first.
[[nodiscard]] std::vector<std::string> instruction_sets();
/// Takes `name` of instruction_sets() for all loops over pairs of the process from now on; "": the best. For tests and
/// benchmarks. Throws std::invalid_argument for other names.
void use_instruction_set(const std::string& name);

} // namespace flotsam::simd
