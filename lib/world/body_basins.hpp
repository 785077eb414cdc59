#pragma once

#include "flotsam/sph/neighbourhood.hpp"
#include "geometry/disjoint_sets.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

/// A vertical line through the water.
struct SoundingLine {
    double level = 0.0;                ///< of the water there [m]
    std::vector<std::uint32_t> column; ///< particles on it
};

/// Tells which water is that of which body: what hangs together with it below the surface. Particles next to each other
/// hang together, but for pairs that something hides from each other; two places do if a way leads from one to the
/// other that stays a spacing below the lower of their levels, so that water that runs over a dam joins no basins.
class BodyBasins {
  public:
    /// `touching`: particles at each body, in any order; those of a body without any are not asked for.
    BodyBasins(std::span<const Vec4> position, const SelfPairs& pairs, double particle_spacing,
               std::vector<std::vector<std::uint32_t>> touching);

    /// For each body the numbers of the lines in its water. A body that stands in two waters is in the lower one, and
    /// in what of the other is no higher.
    [[nodiscard]] std::vector<std::vector<std::size_t>> lines_of_bodies(const std::vector<SoundingLine>& lines);

  private:
    void fill_up_to(double height);
    [[nodiscard]] std::vector<std::size_t> roots_of(const SoundingLine& line);
    [[nodiscard]] std::vector<std::size_t> roots_at(std::size_t body);
    [[nodiscard]] bool reaches(const SoundingLine& line, std::span<const std::size_t> roots);
    static void add_lower(std::span<const std::size_t> lower, const std::vector<std::vector<char>>& hangs,
                          std::vector<std::size_t>& lines_of_body);

    std::span<const Vec4> position_;
    const SelfPairs& pairs_;
    double spacing_;
    std::vector<std::vector<std::uint32_t>> touching_;
    std::vector<std::uint32_t> upwards_; ///< all particles, the lowest first
    std::size_t filled_ = 0;             ///< of these
    std::vector<char> is_filled_;        ///< by particle
    DisjointSets waters_;                ///< of filled particles
};

} // namespace flotsam
