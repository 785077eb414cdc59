// A sphere that is moved to and fro under water: the part of the water's force that goes with its acceleration.
#include "validation/driven_sphere.hpp"

#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "validation/case.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace flotsam::validation {
namespace {

constexpr double kRadius = 0.1, kEdge = 6.0 * kRadius;      ///< of the sphere; of the tank and the water in it [m]
constexpr double kAmplitude = 0.05 * kRadius, kRate = 60.0; ///< of the motion along x [m], [rad/s]
/// Of the displaced mass. Without walls 1/2; by images of its dipole in walls and floor (their own) and surface
/// (reversed), for motion along x.
constexpr double kAddedMass = 0.5204;

/// x(t) = kAmplitude (1 - cos(kRate t)), which no force changes.
class DrivenSphere final : public Bodies {
  public:
    [[nodiscard]] std::size_t size() const override { return 1; }
    void read(double dt, std::span<BodyState> states) override
    {
        next_ = time_ + dt;
        states[0].pose.position = at(time_);
        states[0].start.linear = Vec3d(velocity_, 0, 0);
        states[0].predicted.linear = (at(next_) - at(time_)) / dt;
        states[0].responds = false;
        acceleration_ = (states[0].predicted.linear.x() - velocity_) / dt;
        velocity_ = states[0].predicted.linear.x();
    }
    void respond(std::span<const Wrench>, std::span<Twist> twists) const override { twists[0] = Twist{}; }
    void apply(std::span<const Wrench>) override { time_ = next_; }

    /// Of the last step [m/s], [m/s^2].
    [[nodiscard]] double velocity() const { return velocity_; }
    [[nodiscard]] double acceleration() const { return acceleration_; }

  private:
    static Vec3d at(double time)
    {
        return Vec3d(0.5 * kEdge + kAmplitude * (1.0 - std::cos(kRate * time)), 0.5 * kEdge, 0.5 * kEdge);
    }
    double time_ = 0.0, next_ = 0.0, velocity_ = 0.0, acceleration_ = 0.0;
};

} // namespace

void run_added_mass(const ValidationOptions& options, ValidationResult& result)
{
    constexpr double kPeriod = 2.0 * std::numbers::pi / kRate;
    const double displaced = kWater * 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3); // [kg]
    for (const double resolution : options.quick ? std::vector{5.0} : std::vector{5.0, 10.0}) {
        const Stopwatch watch;
        FluidWorldSettings settings;
        settings.particle_spacing = kRadius / resolution;
        settings.max_time_step = kPeriod / 40.0;
        settings.threads = options.threads;
        FluidWorld water(settings);
        water.add_box_wall({Vec3d::Zero(), Vec3d(kEdge, kEdge, 1.2 * kEdge)}, {"+z"});
        water.add_block({Vec3d::Zero(), Vec3d::Constant(kEdge)});
        water.add_body(tessellate(SphereShape{kRadius}, settings.particle_spacing));
        DrivenSphere sphere;
        water.prepare(sphere);
        // Least squares of the force over acceleration, velocity and one, over whole periods.
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        while (water.time() < 4.0 * kPeriod - 1e-9) {
            const double dt = std::min(water.allowed_time_step(), 4.0 * kPeriod - water.time());
            water.step(dt, sphere);
            const Eigen::Vector3d terms(sphere.acceleration(), sphere.velocity(), 1.0);
            normal += dt * terms * terms.transpose();
            right += dt * water.fluid_wrench(0).linear.x() * terms;
        }
        const Eigen::Vector3d fit = normal.ldlt().solve(right);
        result.checks.push_back({"added mass / displaced mass", "-", resolution, -fit[0] / displaced, kAddedMass,
                                 0.1 * kAddedMass, std::nullopt, water.time(), watch.seconds()});
    }
    result.notes.push_back(
        "Moved along x by a twentieth of its radius to each side at 60 rad/s. Slower, the packing of "
        "particles that touch it takes part as a spring: 0.3 of the displaced mass at 25 rad/s.");
}

} // namespace flotsam::validation
