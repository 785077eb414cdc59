#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/kernel.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "geometry/sheet.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Takes out of the pairs what a sheet lies between. A sheet is thinner than the reach of the kernel, and has samples
/// for each of its sides (BoundaryState::normal).
class SheetScreen {
  public:
    struct Placed {
        std::size_t owner;
        const Sheet& sheet;
        Pose pose;
        double rim_weight; ///< of its samples for water beyond its rim
    };
    /// Pairs of particles, and of particles and samples, with the sheet between them get slope 0, and their part in
    /// the kernel sums goes; beyond the rim of the sheet, where all water is seen and less of the sheet, a part of
    /// both. Symmetric in pairs of particles. Nothing happens if no sample of the sheet is in the pairs.
    /// **Guarantees:** the same for any number of workers.
    void hide(const Placed& placed, const Kernel& kernel, std::span<const Vec4> position, const BoundaryState& boundary,
              const Workers& workers, SelfPairs& fluid_pairs, Pairs& boundary_pairs);

  private:
    /// Points of one kind near the sheet.
    struct Near {
        std::vector<char> is_near;         ///< of all points
        std::vector<std::uint32_t> points; ///< those that are
        std::vector<std::int32_t> number;  ///< of all points, in `points`; -1: none
        std::vector<SheetView> views;      ///< of `points`, world frame

        void number_points();
        [[nodiscard]] const SheetView* view_of(std::uint32_t point) const
        {
            return number[point] < 0 ? nullptr : &views[static_cast<std::size_t>(number[point])];
        }
    };
    void find_near(std::int32_t owner, std::size_t particles, const BoundaryState& boundary, const Workers& workers,
                   const Pairs& boundary_pairs);

    Near fluid_, samples_;
};

} // namespace flotsam
