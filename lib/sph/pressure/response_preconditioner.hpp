#pragma once

#include "sph/pressure/pressure_system.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Preconditioner for the pressure system on the particles that are free (x > 0): the fluid's diagonal, and the answer
/// of each body by itself whole, not only its diagonal. A light body puts six eigenvalues into A that are larger than
/// all others by the ratio of the masses; this takes them out.
///
///     M = F + sum_k U_k U_k^T,   row i of U_k: sqrt(m) L_k^T row_ik,   Y_k = L_k L_k^T,   F diagonal
///
/// A particle that touches several bodies counts as touching the first of them; of the others it gets the diagonal in
/// F, so that M stays positive definite. M is inverted on the free particles by the Sherman-Morrison-Woodbury formula:
/// one 6 x 6 system for each body.
class ResponsePreconditioner {
  public:
    /// `mobility`: each owner's answer to impulses on itself, zero for those that do not respond. `fluid_diagonal`:
    /// that of A without any response.
    void build(const PressureSystem& system, std::span<const Eigen::Matrix<double, 6, 6>> mobility,
               std::span<const Scalar> fluid_diagonal);

    /// z = M^-1 g on the particles with x > 0, and zero on the others.
    void apply(std::span<const Scalar> x, std::span<const Scalar> g, std::span<Scalar> z);

  private:
    struct Sums {
        Eigen::Matrix<double, 6, 7> value = Eigen::Matrix<double, 6, 7>::Zero(); ///< [U^T F^-1 U, U^T F^-1 g]
        Sums& operator+=(const Sums& other)
        {
            value += other.value;
            return *this;
        }
    };
    const PressureSystem* system_ = nullptr;
    std::vector<Scalar> inverse_;     ///< of F
    std::vector<std::size_t> owners_; ///< that respond
    std::vector<Vec6> columns_;       ///< rows of U, as the rows of the contacts; zero where another body counts
    std::vector<char> is_taken_;      ///< particle counts as touching a body already
    std::vector<Sums> sums_;
};

} // namespace flotsam
