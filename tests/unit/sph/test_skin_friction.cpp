#include "sph/forces/skin_friction.hpp"
#include "support/catch.hpp"

#include <cmath>

using namespace flotsam;

namespace {

constexpr double kSpacing = 0.02, kWater = 1000.0, kViscosity = 1e-6, kStep = 1e-3;
constexpr int kAcross = 20; ///< particles along each edge of the plate, and samples

/// Particles that lie over a plate (owner 1; owner 0 is a wall that they touch as well), each next to one sample.
struct Plate {
    FluidState fluid;
    BoundaryState boundary;
    Pairs pairs;
    Contacts contacts;
    std::vector<Vec3d> centers = {Vec3d::Zero(), Vec3d(0.1, 0.05, -0.3)};
    std::vector<Twist> twists = {Twist{}, Twist{}};
    double mass = 1e9; ///< of the plate, which does not turn [kg]
    std::vector<Vec4> change;
    std::vector<Wrench> impulses = {Wrench{}, Wrench{}};

    Plate()
    {
        constexpr int kCount = kAcross * kAcross;
        contacts.start = {0, kCount, 2 * kCount};
        for (int owner = 0; owner < 2; ++owner)
            for (int i = 0; i < kCount; ++i) {
                Vec6 row = Vec6::Zero();
                row[2] = static_cast<Scalar>(owner == 0 ? 1.0 : -3.0 - i % 3);
                contacts.particle.push_back(static_cast<std::uint32_t>(i));
                contacts.row.push_back(row);
            }
        for (int i = 0; i < kCount; ++i) {
            const Vec4 at(static_cast<Scalar>(kSpacing * (i % kAcross)), static_cast<Scalar>(kSpacing * (i / kAcross)),
                          Scalar(0), Scalar(0));
            fluid.position.push_back(at);
            boundary.position.push_back(at - Vec4(0, 0, static_cast<Scalar>(kSpacing), 0));
            boundary.owner.push_back(1);
            pairs.start.push_back(static_cast<std::uint32_t>(i));
            pairs.index.push_back(static_cast<std::uint32_t>(i));
        }
        pairs.start.push_back(kCount);
        fluid.velocity.assign(kCount, Vec4::Zero());
        fluid.pressure.assign(kCount, Scalar(1));
        fluid.particle_mass = kWater * std::pow(kSpacing, 3);
        change.assign(kCount, Vec4::Zero());
    }
    void rub()
    {
        const auto respond = [&](std::span<const Wrench> offered, std::span<Twist> answers) {
            answers[1].linear = offered[1].linear / mass;
        };
        SkinFriction().add({kViscosity, kSpacing, kWater, 3}, kStep, fluid, boundary, pairs, contacts, 1, centers,
                           twists, respond, Workers(2), change, impulses);
    }
    [[nodiscard]] static double area() { return 0.61 * std::pow(kAcross * kSpacing, 2); }
};

} // namespace

TEST_CASE("a plate's friction is Blasius' and, at high speed, Prandtl's", "[sph]")
{
    CHECK(plate_friction(1e4) == Approx(0.01328));
    CHECK(plate_friction(4.99e5) == Approx(plate_friction(5.01e5)).epsilon(0.01));
    CHECK(plate_friction(1e7) == Approx(0.002772).epsilon(0.001));
}

TEST_CASE("water and a plate that slides along it exchange the plate's friction", "[sph]")
{
    Plate plate;
    const double speed = GENERATE(0.05, 0.5, 5.0);
    plate.twists[1].linear = Vec3d(0.6, -0.8, 3.0) * speed; // across the surface nothing rubs
    plate.rub();
    const double stress = 0.5 * kWater * speed * speed * plate_friction(speed * std::sqrt(Plate::area()) / kViscosity);
    const Vec3d exact = -kStep * stress * Plate::area() * Vec3d(0.6, -0.8, 0.0);
    CHECK((plate.impulses[1].linear - exact).norm() < 1e-5 * exact.norm());
    Vec3d linear = plate.impulses[1].linear, angular = plate.impulses[1].seen_at(plate.centers[1]).angular;
    for (std::size_t i = 0; i < plate.change.size(); ++i) {
        const Vec3d gained = plate.fluid.particle_mass * plate.change[i].head<3>().cast<double>();
        linear += gained;
        angular += Vec3d(plate.fluid.position[i].head<3>().cast<double>()).cross(gained);
    }
    CHECK(linear.norm() < 1e-6 * exact.norm());
    CHECK(angular.norm() < 1e-6 * exact.norm());
    CHECK(plate.impulses[0].linear.norm() == 0.0);
}

TEST_CASE("friction takes energy, however light the body", "[sph]")
{
    Plate plate;
    plate.mass = GENERATE(1e-9, 1e-6, 1e-4, 1e-2);
    const double speed = GENERATE(0.01, 0.3, 10.0);
    plate.twists[1].linear = Vec3d(speed, 0, 0);
    plate.rub();
    const double after = speed + plate.impulses[1].linear.x() / plate.mass;
    double energy = 0.5 * plate.mass * after * after;
    for (const Vec4& v : plate.change) energy += 0.5 * plate.fluid.particle_mass * static_cast<double>(v.squaredNorm());
    CHECK(energy < 0.5 * plate.mass * speed * speed * (1.0 + 1e-6));
    CHECK(after < speed);
    CHECK(after > -1e-6 * speed);
}

TEST_CASE("water without pressure rubs nothing, nor does water that goes with the body", "[sph]")
{
    Plate plate;
    plate.twists[1].linear = Vec3d(0.3, 0, 0);
    SECTION("no pressure")
    {
        plate.fluid.pressure.assign(plate.fluid.pressure.size(), Scalar(0));
    }
    SECTION("no slip")
    {
        plate.fluid.velocity.assign(plate.fluid.velocity.size(), Vec4(Scalar(0.3), 0, 0, 0));
    }
    plate.rub();
    CHECK(plate.impulses[1].linear.norm() < 1e-9 * kStep);
}

TEST_CASE("what viscosity has rubbed off a body is not rubbed off again", "[sph]")
{
    Plate plate;
    plate.twists[1].linear = Vec3d(0.3, 0, 0);
    plate.rub();
    const Wrench all = plate.impulses[1];
    const double part = GENERATE(0.25, 1.0, 3.0);
    plate.impulses[1] = {part * all.linear, part * all.angular};
    plate.rub();
    CHECK(plate.impulses[1].linear.x() == Approx(std::max(1.0, part) * all.linear.x()).epsilon(1e-9));
}
