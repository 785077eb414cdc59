#pragma once

#include "flotsam/world/bodies.hpp"

#include <vector>

namespace flotsam::test {

/// A rigid body with a diagonal inertia in its own frame.
struct FreeBody {
    double mass = 1.0;
    Vec3d inertia = Vec3d::Ones(); ///< [kg m^2]
    Pose pose;
    Vec3d momentum = Vec3d::Zero();         ///< [kg m/s]
    Vec3d angular_momentum = Vec3d::Zero(); ///< about the centre of mass [kg m^2/s]

    [[nodiscard]] Mat3d inverse_inertia() const
    {
        const Mat3d axes = pose.orientation.toRotationMatrix();
        return axes * inertia.cwiseInverse().asDiagonal() * axes.transpose();
    }
    [[nodiscard]] Twist twist() const { return {momentum / mass, inverse_inertia() * angular_momentum}; }
};

inline FreeBody free_box(const Vec3d& edges, double density, const Vec3d& position)
{
    FreeBody body;
    body.mass = density * edges.prod();
    const Vec3d sq = edges.cwiseAbs2();
    body.inertia = body.mass / 12.0 * (Vec3d::Constant(sq.sum()) - sq);
    body.pose.position = position;
    return body;
}

/// The simplest bodies: nothing but gravity and the fluid acts on them, and the momenta are the state, so that they are
/// conserved to the last digits. apply() also moves the bodies. It allocates nothing.
class FreeBodies final : public Bodies {
  public:
    explicit FreeBodies(std::vector<FreeBody> given, const Vec3d& gravity = Vec3d::Zero())
        : bodies(std::move(given)), gravity_(gravity)
    {
    }

    std::vector<FreeBody> bodies;

    [[nodiscard]] std::size_t size() const override { return bodies.size(); }
    void read(double dt, std::span<BodyState> states) override
    {
        dt_ = dt;
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            Twist predicted = bodies[k].twist();
            predicted.linear += dt * gravity_;
            states[k] = {bodies[k].pose, predicted, true, bodies[k].twist()};
        }
    }
    void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const override
    {
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            twists[k] = {impulses[k].linear / bodies[k].mass, bodies[k].inverse_inertia() * impulses[k].angular};
        }
    }
    void apply(std::span<const Wrench> impulses) override
    {
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            FreeBody& body = bodies[k];
            body.momentum += body.mass * dt_ * gravity_ + impulses[k].linear;
            body.angular_momentum += impulses[k].angular;
            const Twist twist = body.twist();
            body.pose.position += dt_ * twist.linear;
            const double angle = dt_ * twist.angular.norm();
            if (!(angle > 0.0)) continue;
            const Quatd turn(Eigen::AngleAxisd(angle, twist.angular.normalized()));
            body.pose.orientation = (turn * body.pose.orientation).normalized();
        }
    }

  private:
    Vec3d gravity_;
    double dt_ = 0.0;
};

} // namespace flotsam::test
