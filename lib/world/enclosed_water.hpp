#pragma once

#include "flotsam/sph/neighbourhood.hpp"
#include "geometry/disjoint_sets.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Tells water that solids shut in on all sides from water with a free surface.
class EnclosedWater {
  public:
    /// As the pairs were found. `own_gradient`: sum_j m grad W_ij + sum_b rho0 V_b grad W_ib of each particle, which
    /// vanishes inside of water and at walls [kg/m^4].
    struct Water {
        std::span<const Vec4> position;
        const SelfPairs& pairs;
        std::span<const Vec4> own_gradient;
        double rest_density;
        double particle_spacing;
        int dimensions;
    };

    /// The largest mean length of `shift` [m] in water that hangs together and has no free surface; 0 if there is none.
    [[nodiscard]] double mean_shift(const Water& water, std::span<const Vec4> shift);

  private:
    struct Body {
        double length = 0.0; ///< of all shifts [m]
        std::size_t particles = 0, at_surface = 0;
    };
    DisjointSets sets_;
    std::vector<Body> bodies_; ///< of water, by their root
};

} // namespace flotsam
