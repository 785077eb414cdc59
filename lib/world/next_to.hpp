#pragma once

#include "flotsam/sph/neighbourhood.hpp"

#include <cstdint>
#include <span>

namespace flotsam {

/// Calls visit(j) for the particles that hang together with particle i: next to it, and not hidden from it.
template <class Visit>
void visit_next_to(std::span<const Vec4> position, const SelfPairs& pairs, double particle_spacing, std::uint32_t i,
                   Visit&& visit)
{
    constexpr double kNextTo = 1.5; // spacings: particles of resting water have neighbours at 0.9 to 1.2
    const Scalar reach_sq = static_cast<Scalar>(kNextTo * kNextTo * particle_spacing * particle_spacing);
    for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
        const std::uint32_t j = pairs.neighbour(i, k);
        if (pairs.parts[k] != 0 && (position[i] - position[j]).template head<3>().squaredNorm() < reach_sq) visit(j);
    }
}

} // namespace flotsam
