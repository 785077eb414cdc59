#pragma once

#include "sph/pressure/pressure_system.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Largest eigenvalue of D^-1 A, D a diagonal, by power iteration on D^-1/2 A D^-1/2 from the vector that the last call
/// ended with: a little too small. Particles whose diagonal is 0 are left out.
class LargestEigenvalue {
  public:
    double of(PressureOperator& op, std::span<const Scalar> diagonal);
    /// Products with A that the last call took.
    [[nodiscard]] int products() const { return products_; }

  private:
    int products_ = 0;
    std::vector<Scalar> vector_, scaled_, product_;
    std::vector<double> sums_;
};

} // namespace flotsam
