#include "sph/pressure/pressure_system.hpp"

#include "flotsam/core/contracts.hpp"
#include "sph/simd/pair_sums.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace flotsam {

Eigen::Matrix<double, 6, 6> transposed_root(const Eigen::Matrix<double, 6, 6>& mobility)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(mobility);
    return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

void PressureSystem::velocity_change(std::span<const Scalar> x, std::span<Vec4> dv) const
{
    std::vector<Vec4>& at = *scratch_;
    at.resize(size());
    workers_->for_each(size(), [&](std::size_t i) {
        at[i] = position_[i];
        at[i][3] = x[i];
    });
    workers_->for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_gradients(*pairs_, at, begin, end, dv);
        for (std::size_t i = begin; i < end; ++i) dv[i] = -mass_ * dv[i] - x[i] * contacts_->gradient[i];
    });
}

void PressureSystem::density_rate(std::span<const Vec4> velocity, std::span<const Twist> twists,
                                  std::span<Scalar> rate) const
{
    workers_->for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_differences(*pairs_, position_, velocity, begin, end, rate);
        for (std::size_t i = begin; i < end; ++i) {
            rate[i] = mass_ * rate[i] + velocity[i].dot(contacts_->gradient[i]); // w is zero in either
        }
    });
    for (std::size_t owner = 0; owner < twists.size(); ++owner) {
        Vec6 twist;
        twist << twists[owner].linear.cast<Scalar>(), twists[owner].angular.cast<Scalar>();
        if (twist.isZero(0)) continue;
        const std::size_t first = contacts_->start[owner];
        workers_->for_each(contacts_->start[owner + 1] - first, [&](std::size_t k) {
            rate[contacts_->particle[first + k]] -= contacts_->row[first + k].dot(twist);
        });
    }
}

void PressureSystem::impulses(std::span<const Scalar> x, std::span<Wrench> out) const
{
    FLOTSAM_ASSERT(out.size() == contacts_->owners(), "one wrench per owner");
    workers_->for_each(out.size(), [&](std::size_t owner) {
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (std::uint32_t k = contacts_->start[owner]; k < contacts_->start[owner + 1]; ++k) {
            sum += static_cast<double>(x[contacts_->particle[k]]) * contacts_->row[k].cast<double>();
        }
        out[owner] = {static_cast<double>(mass_) * sum.head<3>(), static_cast<double>(mass_) * sum.tail<3>()};
    });
}

void PressureSystem::fluid_diagonal(std::span<Scalar> diagonal) const
{
    std::vector<Vec4>& sums = *scratch_;
    sums.resize(size());
    workers_->for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_gradient_squares(*pairs_, position_, begin, end, sums);
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 total = (mass_ * sums[i] + contacts_->gradient[i]).head<3>();
            diagonal[i] = total.squaredNorm() + mass_ * mass_ * sums[i][3];
        }
    });
}

void PressureSystem::add_response_diagonal(std::span<const Eigen::Matrix<double, 6, 6>> mobility,
                                           std::span<Scalar> diagonal) const
{
    using Vec6d = Eigen::Matrix<double, 6, 1>;
    for (std::size_t owner = 0; owner < mobility.size(); ++owner) {
        if (mobility[owner].isZero(0)) continue;
        const Eigen::Matrix<double, 6, 6> root_t = transposed_root(mobility[owner]);
        Vec6d sums = Vec6d::Zero();
        for (std::uint32_t k = contacts_->start[owner]; k < contacts_->start[owner + 1]; ++k) {
            sums += (root_t * contacts_->row[k].cast<double>()).cwiseAbs();
        }
        for (std::uint32_t k = contacts_->start[owner]; k < contacts_->start[owner + 1]; ++k) {
            const Vec6d u = root_t * contacts_->row[k].cast<double>();
            diagonal[contacts_->particle[k]] += mass_ * static_cast<Scalar>(u.cwiseAbs().dot(sums));
        }
    }
}

void PressureOperator::bind(const PressureSystem& system, const OwnerResponse* response, std::size_t owners)
{
    system_ = &system;
    response_ = response;
    preconditioner_ = nullptr;
    velocity_change_.resize(system.size());
    impulses_.resize(owners);
    twists_.assign(owners, Twist{});
}

void PressureOperator::apply(std::span<const Scalar> x, std::span<Scalar> out)
{
    system_->velocity_change(x, velocity_change_);
    if (response_ != nullptr) {
        system_->impulses(x, impulses_);
        (*response_)(impulses_, twists_);
    }
    system_->density_rate(velocity_change_, twists_, out);
    system_->workers().for_each(out.size(), [&](std::size_t i) { out[i] = -out[i]; });
}

} // namespace flotsam
