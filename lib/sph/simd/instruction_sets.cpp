#include "sph/simd/targets.hpp"

#include "sph/simd/instruction_sets.hpp"

#include "flotsam/core/contracts.hpp"

#include <hwy/highway.h>

#include <cstdint>

namespace flotsam::simd {

std::vector<std::string> instruction_sets()
{
    std::vector<std::string> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
    return names;
}

void use_instruction_set(const std::string& name)
{
    std::int64_t mask = 0; // the best
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        if (name == hwy::TargetName(target)) mask = target;
    }
    require(name.empty() || mask != 0, "this processor has no instruction set of that name", 0);
    hwy::SetSupportedTargetsForTest(mask);
    hwy::GetChosenTarget().DeInit(); // the next loop looks again
}

} // namespace flotsam::simd
