#include "sph/pressure/pressure_system.hpp"

#include "flotsam/core/contracts.hpp"
#include "sph/simd/pair_sums.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>

namespace flotsam {

Eigen::Matrix<double, 6, 6> transposed_root(const Eigen::Matrix<double, 6, 6>& mobility)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(mobility);
    return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

PressureSystem::PressureSystem(const SelfPairs& pairs, std::span<const Vec4> position, const Contacts& contacts,
                               double particle_mass, const Workers& workers, Scratch& scratch, Lent lent)
    : pairs_(&pairs), contacts_(&contacts), mass_(static_cast<Scalar>(particle_mass)), workers_(&workers),
      scratch_(&scratch), lent_(lent)
{
    constexpr std::uint32_t kSlice = 1024; // rows
    std::vector<Vec4>&unknowns = *lent.unknowns, &own = *lent.own_gradient;
    unknowns.assign(position.begin(), position.end());
    own.resize(size());
    scratch.change.resize(size());
    const Vec4 factor(mass_, mass_, mass_, mass_ * mass_);
    workers.for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_gradient_squares(pairs, unknowns, begin, end, own);
        for (std::size_t i = begin; i < end; ++i) own[i] = factor.cwiseProduct(own[i]);
    });
    const std::size_t most_slices = contacts.owners() + contacts.row.size() / kSlice;
    if (scratch.slices.capacity() < most_slices) {
        scratch.slices.reserve(2 * most_slices); // contacts come and go
        scratch.sums.reserve(2 * most_slices);
    }
    scratch.slices.clear();
    for (std::size_t owner = 0; owner < contacts.owners(); ++owner) {
        const std::uint32_t first = contacts.start[owner], last = contacts.start[owner + 1];
        workers.for_each(last - first, [&](std::size_t k) {
            own[contacts.particle[first + k]].head<3>() += contacts.row[first + k].head<3>();
        });
        for (std::uint32_t k = first; k < last; k += kSlice)
            scratch.slices.push_back({static_cast<std::uint32_t>(owner), k, std::min(last, k + kSlice)});
    }
    scratch.sums.resize(scratch.slices.size());
}

void PressureSystem::velocity_change(Give give, std::span<Vec4> dv) const
{
    std::vector<Vec4>& unknowns = *lent_.unknowns;
    workers_->for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) { give(begin, end, unknowns); });
    workers_->for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        simd::sum_gradients(*pairs_, unknowns, begin, end, dv);
        for (std::size_t i = begin; i < end; ++i) {
            dv[i] = -mass_ * dv[i] - unknowns[i][3] * (*lent_.own_gradient)[i];
            dv[i][3] = 0;
        }
    });
}

void PressureSystem::velocity_change(std::span<const Scalar> x, std::span<Vec4> dv) const
{
    velocity_change(GiveValues{x}, dv);
}

void PressureSystem::density_rate(std::span<const Vec4> velocity, std::size_t begin, std::size_t end,
                                  std::span<Scalar> rate) const
{
    simd::sum_divergences(*pairs_, *lent_.unknowns, velocity, begin, end, rate);
    for (std::size_t i = begin; i < end; ++i) {
        rate[i - begin] = velocity[i].head<3>().dot((*lent_.own_gradient)[i].head<3>()) - mass_ * rate[i - begin];
    }
}

void PressureSystem::density_rate(std::span<const Vec4> velocity, std::span<const Twist> twists,
                                  std::span<Scalar> rate) const
{
    workers_->for_chunks(size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        density_rate(velocity, begin, end, rate.subspan(begin));
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

template <class Unknown>
void PressureSystem::sum_impulses(Unknown&& x, std::span<Wrench> out) const
{
    FLOTSAM_ASSERT(out.size() == contacts_->owners(), "one wrench per owner");
    const std::vector<Slice>& slices = scratch_->slices;
    std::vector<Eigen::Matrix<double, 6, 1>>& sums = scratch_->sums;
    workers_->for_tasks(slices.size(), [&](std::size_t s) {
        sums[s].setZero();
        for (std::uint32_t k = slices[s].first; k < slices[s].last; ++k)
            sums[s] += static_cast<double>(x(contacts_->particle[k])) * contacts_->row[k].cast<double>();
    });
    std::fill(out.begin(), out.end(), Wrench{});
    const double mass = static_cast<double>(mass_);
    for (std::size_t s = 0; s < slices.size(); ++s)
        out[slices[s].owner] += {mass * sums[s].head<3>(), mass * sums[s].tail<3>()};
}

void PressureSystem::impulses(std::span<const Scalar> x, std::span<Wrench> out) const
{
    sum_impulses([&](std::size_t i) { return x[i]; }, out);
}

void PressureSystem::impulses(std::span<Wrench> out) const
{
    sum_impulses([&](std::size_t i) { return unknown(i); }, out);
}

void PressureSystem::fluid_diagonal(std::span<Scalar> diagonal) const
{
    workers_->for_each(size(), [&](std::size_t i) {
        const Vec4& own = (*lent_.own_gradient)[i];
        diagonal[i] = own.head<3>().squaredNorm() + own[3];
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
            Scalar& of_particle = diagonal[contacts_->particle[k]];
            if (of_particle > Scalar(0)) of_particle += mass_ * static_cast<Scalar>(u.cwiseAbs().dot(sums));
        }
    }
}

void PressureOperator::bind(const PressureSystem& system, const OwnerResponse* response, std::size_t owners)
{
    system_ = &system;
    response_ = response;
    preconditioner_ = nullptr;
    impulses_.resize(owners);
    twists_.assign(owners, Twist{});
}

void PressureOperator::apply(PressureSystem::Give give, Take take)
{
    const PressureSystem& system = *system_;
    const Workers& workers = system.workers();
    system.velocity_change(give, system.change());
    if (response_ == nullptr) {
        workers.for_chunks(system.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            std::array<Scalar, Workers::kChunk> product;
            system.density_rate(system.change(), begin, end, product);
            for (std::size_t k = 0; k < end - begin; ++k) product[k] = -product[k];
            take(chunk, begin, end, std::span<const Scalar>(product).first(end - begin));
        });
        return;
    }
    system.impulses(impulses_);
    (*response_)(impulses_, twists_);
    product_.resize(system.size());
    system.density_rate(system.change(), twists_, product_);
    workers.for_chunks(system.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) product_[i] = -product_[i];
        take(chunk, begin, end, std::span<const Scalar>(product_).subspan(begin, end - begin));
    });
}

void PressureOperator::apply(std::span<const Scalar> x, std::span<Scalar> out)
{
    apply(PressureSystem::GiveValues{x},
          [&](std::size_t, std::size_t begin, std::size_t, std::span<const Scalar> product) {
              std::copy(product.begin(), product.end(), out.begin() + static_cast<std::ptrdiff_t>(begin));
          });
}

} // namespace flotsam
