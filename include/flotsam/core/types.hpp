#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>

namespace flotsam {

/// Number type of particle state. Sums over many particles and everything about bodies are double.
using Scalar = float;

using Vec3 = Eigen::Matrix<Scalar, 3, 1>;
using Vec4 = Eigen::Matrix<Scalar, 4, 1>; ///< particle state in memory: x, y, z and one scalar, 16-byte aligned
using Vec3d = Eigen::Vector3d;
using Mat3d = Eigen::Matrix3d;
using Quatd = Eigen::Quaterniond;

/// Axis-aligned box, world frame, metres.
struct Aabb {
    Vec3d min = Vec3d::Constant(1e300);
    Vec3d max = Vec3d::Constant(-1e300);

    [[nodiscard]] bool empty() const { return !(min.array() <= max.array()).all(); }
    [[nodiscard]] Vec3d size() const { return max - min; }
    [[nodiscard]] Vec3d center() const { return 0.5 * (min + max); }
    [[nodiscard]] bool contains(const Vec3d& p) const
    {
        return (p.array() >= min.array()).all() && (p.array() <= max.array()).all();
    }
    void extend(const Vec3d& p)
    {
        min = min.cwiseMin(p);
        max = max.cwiseMax(p);
    }
    [[nodiscard]] Aabb inflated(double by) const { return {min - Vec3d::Constant(by), max + Vec3d::Constant(by)}; }
};

/// Rigid placement: world point = position + orientation * body point.
struct Pose {
    Vec3d position = Vec3d::Zero();        ///< [m]
    Quatd orientation = Quatd::Identity(); ///< body to world

    [[nodiscard]] Vec3d to_world(const Vec3d& point_body) const { return position + orientation * point_body; }
    [[nodiscard]] Vec3d to_body(const Vec3d& point) const { return orientation.conjugate() * (point - position); }
    [[nodiscard]] Pose operator*(const Pose& inner) const
    {
        return {to_world(inner.position), (orientation * inner.orientation).normalized()};
    }
};

/// Rigid velocity about a body's centre of mass, world frame.
struct Twist {
    Vec3d linear = Vec3d::Zero();  ///< [m/s]
    Vec3d angular = Vec3d::Zero(); ///< [rad/s]

    [[nodiscard]] Vec3d at(const Vec3d& arm) const { return linear + angular.cross(arm); }
};

/// Where a body is that went on with a twist about its centre of mass for dt seconds.
[[nodiscard]] inline Pose moved(const Pose& pose, const Twist& twist, double dt)
{
    const Vec3d turn = twist.angular * dt;
    const double angle = turn.norm();
    const Quatd rotation = angle > 0.0 ? Quatd(Eigen::AngleAxisd(angle, turn / angle)) : Quatd::Identity();
    return {pose.position + dt * twist.linear, (rotation * pose.orientation).normalized()};
}

/// Force and torque, or their impulses, about a body's centre of mass (unless said otherwise), world frame.
struct Wrench {
    Vec3d linear = Vec3d::Zero();  ///< [N] or [N s]
    Vec3d angular = Vec3d::Zero(); ///< [N m] or [N m s]

    Wrench& operator+=(const Wrench& other)
    {
        linear += other.linear;
        angular += other.angular;
        return *this;
    }
    [[nodiscard]] Wrench operator+(const Wrench& other) const
    {
        return {linear + other.linear, angular + other.angular};
    }
    [[nodiscard]] Wrench operator-(const Wrench& other) const
    {
        return {linear - other.linear, angular - other.angular};
    }
    [[nodiscard]] Wrench operator*(double factor) const { return {linear * factor, angular * factor}; }
    /// The same about another point, from which the present one is seen at `arm`.
    [[nodiscard]] Wrench seen_at(const Vec3d& arm) const { return {linear, angular + arm.cross(linear)}; }
};

} // namespace flotsam
