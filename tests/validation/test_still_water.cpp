#include "support/catch.hpp"
#include "support/scene_run.hpp"

#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"

#include <cmath>

using namespace flotsam;

namespace {

/// Bodies that are held where they are.
class HeldBody final : public Bodies {
  public:
    explicit HeldBody(const Vec3d& place) { state_.pose.position = place; }
    [[nodiscard]] std::size_t size() const override { return 1; }
    void read(double, std::span<BodyState> states) override { states[0] = state_; }
    void respond(std::span<const Wrench>, std::span<Twist> twists) const override { twists[0] = {}; }
    void apply(std::span<const Wrench>) override {}

  private:
    BodyState state_;
};

double mean_speed(const FluidState& fluid)
{
    double sum = 0.0;
    for (const Vec4& v : fluid.velocity) sum += static_cast<double>(v.norm());
    return sum / static_cast<double>(fluid.size());
}

} // namespace

TEST_CASE("a still tank: pressure, force, level, rest", "[validation][still]")
{
    const int dimensions = GENERATE(2, 3);
    CAPTURE(dimensions);
    FluidWorldSettings settings;
    settings.dimensions = dimensions;
    const double d = settings.particle_spacing;
    const Vec3d size(dimensions == 2 ? 0.8 : 0.36, dimensions == 2 ? 1.0 : 0.36, 0.32);
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), size + Vec3d(0, 0, 0.2)}, {"+z"});
    world.add_block({Vec3d::Zero(), size});
    NoBodies none;
    double force = 0.0, pressure = 0.0, level = 0.0, speed = 0.0, compression = 0.0, seconds = 0.0;
    while (world.time() < 4.0) {
        const double dt = world.allowed_time_step();
        const StepReport report = world.step(dt, none);
        CHECK(report.leaked == 0);
        if (world.time() < 3.0) continue;
        seconds += dt;
        force -= dt * world.wall_force(0).z();
        compression += dt * report.compression_mean;
        double floor = 0.0, height = 0.0;
        speed += dt * mean_speed(world.fluid());
        for (int k = 1; k < 8; ++k) {
            const Vec3d at(size.x() * k / 8.0, dimensions == 2 ? 0.0 : size.y() * (k % 4 + 0.5) / 4.0, 0.0);
            floor += world.pressure_at(at) / 7.0;
            height += world.level_at(at.x(), at.y()).value_or(0.0) / 7.0;
        }
        pressure += dt * floor;
        level += dt * height;
    }
    const double width = dimensions == 2 ? 1.0 : size.y();
    const double weight = 9.81 * 1000.0 * size.x() * width * size.z();
    REQUIRE(seconds > 0.9);
    CHECK(force / seconds == Approx(weight).epsilon(0.005));
    CHECK(pressure / seconds == Approx(9810.0 * size.z()).epsilon(0.01));
    CHECK(std::abs(level / seconds - size.z()) < 0.5 * d);
    CHECK(speed / seconds < 0.01 * std::sqrt(9.81 * size.z()));
    CHECK(compression / seconds < settings.pressure.tolerance * 1.05);
}

TEST_CASE("water comes to rest and stays there", "[validation][still]")
{
    // What drives a current or keeps noise alive, be it stress of the packing or errors of the solves, shows late.
    FluidWorldSettings settings;
    settings.dimensions = 2;
    settings.particle_spacing = 0.02;
    settings.max_time_step = 0.004;
    constexpr double kDepth = 0.5;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(1.0, 1.0, 2.0 * kDepth)}, {"+z"});
    world.add_block({Vec3d::Zero(), Vec3d(1.0, 0.0, kDepth)});
    NoBodies none;
    const auto run_until = [&](double end) {
        while (world.time() < end) world.step(world.allowed_time_step(), none);
        return mean_speed(world.fluid()) / std::sqrt(9.81 * kDepth);
    };
    const double early = run_until(6.0), late = run_until(18.0);
    CAPTURE(early, late);
    CHECK(late < 0.002);
    CHECK(late < 0.8 * early);
}

TEST_CASE("a body held under water is lifted by the weight of the water that it displaces", "[validation][buoyancy]")
{
    FluidWorldSettings settings;
    const double d = settings.particle_spacing, diameter = 16 * d;
    FluidWorld world(settings);
    const Vec3d size(0.52, 0.52, 0.52);
    world.add_box_wall({Vec3d::Zero(), size + Vec3d(0, 0, 0.1)}, {"+z"});
    world.add_block({Vec3d::Zero(), size});
    const TriangleMesh sphere = tessellate(SphereShape{diameter / 2}, d / 2);
    world.add_body(sphere);
    HeldBody body(Vec3d(0.26, 0.26, 0.25));
    Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
    double squares = 0.0, seconds = 0.0;
    while (world.time() < 2.0) {
        const double dt = world.allowed_time_step();
        world.step(dt, body);
        if (world.time() < 1.0) continue;
        const Wrench w = world.fluid_wrench(0);
        force += dt * w.linear;
        torque += dt * w.angular;
        squares += dt * w.linear.z() * w.linear.z();
        seconds += dt;
    }
    const double displaced = 9810.0 * mass_properties(sphere).volume;
    force /= seconds;
    torque /= seconds;
    CHECK(force.z() == Approx(displaced).epsilon(0.03));
    CHECK(force.head<2>().norm() < 0.01 * displaced);
    CHECK(torque.norm() < 0.01 * displaced * diameter);
    CHECK(std::sqrt(std::max(0.0, squares / seconds - force.z() * force.z())) < 0.05 * displaced);
}

TEST_CASE("small bodies displace their volume, edges and corners included", "[validation][buoyancy]")
{
    struct Held {
        const char* shape;
        double volume; ///< [spacings^3]
    };
    const Held each = GENERATE(values<Held>({{R"({"box": [0.08, 0.08, 0.08]})", 64.0},
                                             {R"({"sphere": 0.06})", 113.097},
                                             {R"({"box": [0.2, 0.08, 0.08]})", 160.0},
                                             {R"({"box": [0.2, 0.2, 0.06]})", 300.0}}));
    const RunReport report =
        test::run_text(R"({"flotsam": 1, "particle_spacing": 0.02, "duration": 0.8, "start": "at_rest",
        "fluids": [{"blocks": [{"min": [0, 0, 0], "max": [0.44, 0.44, 0.5]}]}],
        "walls": [{"box": {"min": [0, 0, 0], "max": [0.44, 0.44, 0.7], "open": ["+z"]}}],
        "bodies": [{"name": "held", "motion": "fixed", "position": [0.22, 0.22, 0.25], "shape": )" +
                       std::string(each.shape) + "}]}");
    CAPTURE(each.shape);
    const Vec3d force = report.bodies.at(0).force_fluid_mean;
    CHECK(force.z() == Approx(9810.0 * 8e-6 * each.volume).epsilon(0.02));
}
