#pragma once

#include "flotsam/core/types.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace flotsam {

/// Random numbers that are the same with every standard library. **Source:** Steele, Lea & Flood 2014 (SplitMix64).
class SplitMix {
  public:
    explicit SplitMix(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next()
    {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    /// In [0, 1).
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

    /// Uniform over directions whose cosine with z is at least `min_cosine`.
    Vec3d direction_about_z(double min_cosine)
    {
        const double z = min_cosine + (1.0 - min_cosine) * uniform();
        const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
        const double phi = 2.0 * std::numbers::pi * uniform();
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

  private:
    std::uint64_t state_;
};

} // namespace flotsam
