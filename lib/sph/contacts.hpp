#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flotsam {

using Vec6 = Eigen::Matrix<Scalar, 6, 1>;

/// How each owner (wall or body) stands in the densities of the fluid around it: for particle i and owner k
///
///     row = ( sum_b rho0 V_b grad W_ib,  sum_b rho0 V_b (x_b - c_k) x grad W_ib ),  over the samples b of k
///
/// so that d rho_i / dt gains -row . (v_k, omega_k) from k's motion, and a pressure p_i puts the wrench
/// (m p_i / rho_i^2) row on k. Rows of owner k: start[k] .. start[k + 1], particles rising.
struct Contacts {
    std::vector<std::uint32_t> start;    ///< owners + 1
    std::vector<std::uint32_t> particle; ///< of each row
    std::vector<Vec6> row;               ///< [kg/m^4], [kg/m^3]

    [[nodiscard]] std::size_t owners() const { return start.empty() ? 0 : start.size() - 1; }
};

/// Builds Contacts from the fluid's pairs with boundary samples. Scratch is kept between calls.
class ContactBuilder {
  public:
    /// `position`: of the fluid particles [m]; `centers`: of each owner, about which moments are taken [m].
    void build(const Pairs& boundary_pairs, std::span<const Vec4> position, const BoundaryState& boundary,
               std::span<const Vec3d> centers, double rest_density, const Workers& workers, Contacts& contacts);

  private:
    struct Row {
        std::int32_t owner;
        std::uint32_t particle;
        Vec6 row;
    };
    std::vector<std::vector<Row>> rows_; ///< per chunk
};

} // namespace flotsam
