#pragma once

#include "flotsam/core/types.hpp"

#include <array>
#include <vector>

namespace flotsam {

/// Arrays that a force may write to, whatever they hold: at 16 bytes a particle, sharing them is worth it.
using ForceScratch = std::array<std::vector<Vec4>*, 4>;

} // namespace flotsam
