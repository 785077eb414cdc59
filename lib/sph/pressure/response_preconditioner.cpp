#include "sph/pressure/response_preconditioner.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace flotsam {

void ResponsePreconditioner::build(const PressureSystem& system, std::span<const Eigen::Matrix<double, 6, 6>> mobility,
                                   std::span<const Scalar> fluid_diagonal)
{
    system_ = &system;
    owners_.clear();
    const Contacts& contacts = system.contacts();
    inverse_.assign(fluid_diagonal.begin(), fluid_diagonal.end()); // of F itself until the end
    is_taken_.assign(fluid_diagonal.size(), 0);
    columns_.resize(contacts.row.size());
    const Scalar root_mass = std::sqrt(system.particle_mass());
    for (std::size_t owner = 0; owner < mobility.size(); ++owner) {
        if (mobility[owner].isZero(0)) continue;
        owners_.push_back(owner);
        const Eigen::Matrix<Scalar, 6, 6> root = transposed_root(mobility[owner]).cast<Scalar>();
        const std::size_t first = contacts.start[owner];
        system.workers().for_each(contacts.start[owner + 1] - first, [&](std::size_t r) {
            const std::size_t k = first + r, i = contacts.particle[k];
            columns_[k] = root_mass * (root * contacts.row[k]);
            if (is_taken_[i] != 0) {
                inverse_[i] += columns_[k].squaredNorm();
                columns_[k].setZero();
            }
            is_taken_[i] = 1; // a body has one row for a particle
        });
    }
    system.workers().for_each(inverse_.size(), [&](std::size_t i) {
        inverse_[i] = inverse_[i] > Scalar(0) ? Scalar(1) / inverse_[i] : Scalar(0);
    });
}

void ResponsePreconditioner::apply(std::span<const Scalar> x, std::span<const Scalar> g, std::span<Scalar> z)
{
    const Workers& workers = system_->workers();
    const Contacts& contacts = system_->contacts();
    workers.for_each(x.size(), [&](std::size_t i) { z[i] = x[i] > Scalar(0) ? inverse_[i] * g[i] : Scalar(0); });
    for (const std::size_t owner : owners_) {
        const std::size_t first = contacts.start[owner], rows = contacts.start[owner + 1] - first;
        const auto term = [&](std::size_t r) {
            const std::size_t k = first + r, i = contacts.particle[k];
            Sums sums;
            if (!(x[i] > Scalar(0))) return sums;
            const Eigen::Matrix<double, 6, 1> u = columns_[k].cast<double>();
            sums.value << u * (static_cast<double>(inverse_[i]) * u).transpose(), static_cast<double>(z[i]) * u;
            return sums;
        };
        Eigen::Matrix<double, 6, 7> sums = workers.ordered_sum<Sums>(rows, sums_, term).value;
        sums.leftCols<6>().diagonal().array() += 1.0;
        const Vec6 pull = sums.leftCols<6>().ldlt().solve(sums.col(6)).cast<Scalar>();
        workers.for_each(rows, [&](std::size_t r) {
            const std::size_t k = first + r, i = contacts.particle[k];
            if (x[i] > Scalar(0)) z[i] -= inverse_[i] * columns_[k].dot(pull);
        });
    }
}

} // namespace flotsam
