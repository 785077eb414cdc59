#pragma once

#include "flotsam/core/types.hpp"

#include <LinearMath/btTransform.h>

namespace flotsam {

[[nodiscard]] inline Vec3d from_bullet(const btVector3& v)
{
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

[[nodiscard]] inline Mat3d from_bullet(const btMatrix3x3& m)
{
    Mat3d matrix;
    for (int row = 0; row < 3; ++row) matrix.row(row) = from_bullet(m[row]).transpose();
    return matrix;
}

/// The rotation is taken through the quaternion in double, so that it is a rotation to double precision.
[[nodiscard]] inline Pose from_bullet(const btTransform& transform)
{
    return {from_bullet(transform.getOrigin()), Quatd(from_bullet(transform.getBasis())).normalized()};
}

[[nodiscard]] inline btVector3 to_bullet(const Vec3d& v)
{
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

[[nodiscard]] inline Twist twist_from_bullet(const btVector3& linear, const btVector3& angular)
{
    return {from_bullet(linear), from_bullet(angular)};
}

} // namespace flotsam
