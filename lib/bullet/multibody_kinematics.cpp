#include "bullet/multibody_kinematics.hpp"

#include "bullet/convert.hpp"

namespace flotsam {

namespace {

/// Bullet keeps the rotations of a multibody from the outer frame into the inner one.
Quatd outward(const btQuaternion& inward)
{
    return Quatd(static_cast<double>(inward.w()), static_cast<double>(inward.x()), static_cast<double>(inward.y()),
                 static_cast<double>(inward.z()))
        .normalized()
        .conjugate();
}

Mat3d cross(const Vec3d& v)
{
    Mat3d matrix;
    matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return matrix;
}

} // namespace

void MultibodyKinematics::update(const btMultiBody& body)
{
    const int links = body.getNumLinks();
    poses_.resize(static_cast<std::size_t>(links) + 1);
    jacobian_transposed_.setZero(6 + body.getNumDofs(), 6 * (links + 1));

    poses_[0] = {from_bullet(body.getBasePos()), outward(body.getWorldToBaseRot())};
    jacobian_transposed_.block<3, 3>(3, 0).setIdentity();
    jacobian_transposed_.block<3, 3>(0, 3).setIdentity();
    for (int k = 0; k < links; ++k) {
        const btMultibodyLink& link = body.getLink(k);
        const Pose& parent = pose(link.m_parent + 1);
        const Quatd orientation = (parent.orientation * outward(link.m_cachedRotParentToThis)).normalized();
        const Vec3d arm = orientation * from_bullet(link.m_cachedRVector);
        poses_[static_cast<std::size_t>(k) + 1] = {parent.position + arm, orientation};

        auto own = jacobian_transposed_.middleCols<6>(6 * (k + 1));
        const auto inherited = jacobian_transposed(link.m_parent + 1);
        own = inherited;
        own.leftCols<3>() += inherited.rightCols<3>().lazyProduct(cross(arm)); // v + omega x arm, transposed
        for (int dof = 0; dof < link.m_dofCount; ++dof) {
            const int row = 6 + link.m_dofOffset + dof;
            own.row(row).head<3>() = (orientation * from_bullet(link.getAxisBottom(dof))).transpose();
            own.row(row).tail<3>() = (orientation * from_bullet(link.getAxisTop(dof))).transpose();
        }
    }
}

Twist MultibodyKinematics::twist(int link, const Eigen::VectorXd& joint_velocity) const
{
    const auto columns = jacobian_transposed(link);
    Twist twist;
    for (int k = 0; k < 3; ++k) {
        twist.linear[k] = columns.col(k).dot(joint_velocity);
        twist.angular[k] = columns.col(3 + k).dot(joint_velocity);
    }
    return twist;
}

void MultibodyKinematics::gather(int link, const Wrench& wrench, Eigen::VectorXd& joint_force) const
{
    const auto columns = jacobian_transposed(link);
    for (int k = 0; k < 3; ++k)
        joint_force += wrench.linear[k] * columns.col(k) + wrench.angular[k] * columns.col(3 + k);
}

LinkInertia inertia_of(const btMultiBody& body, int link, const Pose& pose)
{
    const Mat3d axes = pose.orientation.toRotationMatrix();
    const Vec3d local = from_bullet(link == 0 ? body.getBaseInertia() : body.getLinkInertia(link - 1));
    const btScalar mass = link == 0 ? body.getBaseMass() : body.getLinkMass(link - 1);
    return {static_cast<double>(mass), axes * local.asDiagonal() * axes.transpose()};
}

} // namespace flotsam
