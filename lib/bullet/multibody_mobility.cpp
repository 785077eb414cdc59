#include "bullet/multibody_mobility.hpp"

#include "flotsam/core/contracts.hpp"

#include <cmath>
#include <limits>

namespace flotsam {

namespace {

/// Of the diagonal of H; a pivot below is rounding.
constexpr double kRounding = 1e-14;
constexpr double kHeld = std::numeric_limits<double>::infinity();

/// H = sum over the links of J^T M J, its upper half.
void add_mass(const MultibodyKinematics& kinematics, int link, const LinkInertia& inertia, Eigen::MatrixXd& mass)
{
    const auto columns = kinematics.jacobian_transposed(link);
    for (int j = 0; j < mass.cols(); ++j) {
        const Vec3d linear = inertia.mass * columns.row(j).head<3>().transpose();
        const Vec3d angular = inertia.tensor * columns.row(j).tail<3>().transpose();
        for (int k = 0; k < 3; ++k)
            mass.col(j).head(j + 1) +=
                linear[k] * columns.col(k).head(j + 1) + angular[k] * columns.col(3 + k).head(j + 1);
    }
}

/// Pivots at or below which Bullet lets a degree of freedom be.
void find_held(const btMultiBody& body, Eigen::VectorXd& smallest)
{
    smallest.setZero(6 + body.getNumDofs());
    if (body.isBaseStaticOrKinematic()) smallest.head<6>().setConstant(kHeld);
    for (int k = 0; k < body.getNumLinks(); ++k) {
        const btMultibodyLink& link = body.getLink(k);
        auto own = smallest.segment(6 + link.m_dofOffset, link.m_dofCount);
        if (link.m_dofCount == 1) own.setConstant(static_cast<double>(SIMD_EPSILON));
        if (body.isLinkAndAllAncestorsKinematic(k)) own.setConstant(kHeld);
    }
}

} // namespace

void MultibodyMobility::update(const btMultiBody& body, const MultibodyKinematics& kinematics)
{
    upper_.setZero(kinematics.dofs(), kinematics.dofs());
    for (int link = 0; link < kinematics.size(); ++link)
        add_mass(kinematics, link, inertia_of(body, link, kinematics.pose(link)), upper_);
    factor(body);

    half_.resize(kinematics.dofs(), 6 * kinematics.size());
    for (int link = 0; link < kinematics.size(); ++link)
        half_.middleCols<6>(6 * link) = kinematics.jacobian_transposed(link);
    for (int column = 0; column < half_.cols(); ++column) half_solve(half_.col(column));
    joint_.resize(kinematics.dofs());
}

void MultibodyMobility::factor(const btMultiBody& body)
{
    find_held(body, smallest_);
    inv_root_.setZero(upper_.rows());
    smallest_ = smallest_.cwiseMax(kRounding * upper_.diagonal());
    for (int k = static_cast<int>(upper_.cols()) - 1; k >= 0; --k) {
        auto column = upper_.col(k).head(k);
        if (!(upper_(k, k) > smallest_[k])) {
            column.setZero();
            continue;
        }
        inv_root_[k] = 1.0 / std::sqrt(upper_(k, k));
        column *= inv_root_[k];
        for (int j = 0; j < k; ++j) upper_.col(j).head(j + 1) -= column[j] * column.head(j + 1);
    }
}

void MultibodyMobility::half_solve(Eigen::Ref<Eigen::VectorXd> x) const
{
    for (int k = static_cast<int>(x.size()) - 1; k >= 0; --k) {
        x[k] *= inv_root_[k];
        x.head(k) -= x[k] * upper_.col(k).head(k);
    }
}

void MultibodyMobility::accelerate(Eigen::VectorXd& joint_force) const
{
    half_solve(joint_force);
    for (int k = 0; k < joint_force.size(); ++k)
        joint_force[k] = (joint_force[k] - upper_.col(k).head(k).dot(joint_force.head(k))) * inv_root_[k];
}

bool MultibodyMobility::responds(int link) const
{
    return !half_.middleCols<6>(6 * link).isZero(0.0);
}

Eigen::Matrix<double, 6, 6> MultibodyMobility::block(int to, int from) const
{
    return half_.middleCols<6>(6 * to).transpose().lazyProduct(half_.middleCols<6>(6 * from));
}

void MultibodyMobility::respond(std::span<const Wrench> impulses, std::span<Twist> twists) const
{
    FLOTSAM_ASSERT(6 * static_cast<Eigen::Index>(impulses.size()) == half_.cols(), "one impulse per link");
    FLOTSAM_ASSERT(twists.size() == impulses.size(), "one twist per link");
    joint_.setZero();
    for (std::size_t link = 0; link < impulses.size(); ++link)
        for (int k = 0; k < 3; ++k) {
            const auto column = static_cast<Eigen::Index>(6 * link) + k;
            joint_ += impulses[link].linear[k] * half_.col(column) + impulses[link].angular[k] * half_.col(column + 3);
        }
    for (std::size_t link = 0; link < twists.size(); ++link)
        for (int k = 0; k < 3; ++k) {
            const auto column = static_cast<Eigen::Index>(6 * link) + k;
            twists[link].linear[k] = half_.col(column).dot(joint_);
            twists[link].angular[k] = half_.col(column + 3).dot(joint_);
        }
}

} // namespace flotsam
