// A sphere that is moved to and fro under water: the part of the water's force that goes with its acceleration.
#include "validation/driven_sphere.hpp"

#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "validation/case.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

namespace flotsam::validation {
namespace {

constexpr double kRadius = 0.1, kEdge = 6.0 * kRadius; ///< of the sphere; of the tank and the water in it [m]
constexpr double kAmplitude = 0.05 * kRadius;          ///< of the motion along x [m]
constexpr double kFast = 60.0, kSlow = 25.0;           ///< [rad/s]
/// Of the displaced mass. Without walls 1/2; by images of its dipole in walls and floor (their own) and surface
/// (reversed), for motion along x.
constexpr double kAddedMass = 0.5204;

/// x(t) = kAmplitude (1 - cos(rate t)), which no force changes.
class DrivenSphere final : public Bodies {
  public:
    explicit DrivenSphere(double rate) : rate_(rate) {} ///< [rad/s]
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
    [[nodiscard]] Vec3d at(double time) const
    {
        return Vec3d(0.5 * kEdge + kAmplitude * (1.0 - std::cos(rate_ * time)), 0.5 * kEdge, 0.5 * kEdge);
    }
    double rate_;
    double time_ = 0.0, next_ = 0.0, velocity_ = 0.0, acceleration_ = 0.0;
};

/// Added mass of a sphere of `resolution` spacings in radius over the displaced mass, and the time that was simulated.
std::pair<double, double> added_mass(double rate, double resolution, const ValidationOptions& options)
{
    const double period = 2.0 * std::numbers::pi / rate;
    FluidWorldSettings settings;
    settings.particle_spacing = kRadius / resolution;
    settings.max_time_step = std::min(period / 40.0, 0.003);
    settings.threads = options.threads;
    FluidWorld water(settings);
    water.add_box_wall({Vec3d::Zero(), Vec3d(kEdge, kEdge, 1.2 * kEdge)}, {"+z"});
    water.add_block({Vec3d::Zero(), Vec3d::Constant(kEdge)});
    water.add_body(tessellate(SphereShape{kRadius}, settings.particle_spacing));
    DrivenSphere sphere(rate);
    water.prepare(sphere);
    // Least squares of the force over acceleration, velocity and one, over whole periods.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const double duration = (rate < kFast ? 2.0 : 4.0) * period;
    while (water.time() < duration - 1e-9) {
        const double dt = std::min(water.allowed_time_step(), duration - water.time());
        water.step(dt, sphere);
        const Eigen::Vector3d terms(sphere.acceleration(), sphere.velocity(), 1.0);
        normal += dt * terms * terms.transpose();
        right += dt * water.fluid_wrench(0).linear.x() * terms;
    }
    const double displaced = kWater * 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3); // [kg]
    return {-normal.ldlt().solve(right)[0] / displaced, duration};
}

} // namespace

void run_added_mass(const ValidationOptions& options, ValidationResult& result)
{
    for (const double resolution : options.quick ? std::vector{5.0} : std::vector{5.0, 10.0})
        for (const double rate : {kFast, kSlow}) {
            const Stopwatch watch;
            const auto [value, simulated] = added_mass(rate, resolution, options);
            std::ostringstream quantity;
            quantity << "added mass / displaced mass, " << rate << " rad/s";
            result.checks.push_back({quantity.str(), "-", resolution, value, kAddedMass, 0.1 * kAddedMass, std::nullopt,
                                     simulated, watch.seconds()});
        }
    result.notes.push_back("Moved along x by a twentieth of its radius to each side.");
}

} // namespace flotsam::validation
