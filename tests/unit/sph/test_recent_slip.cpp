#include "sph/forces/recent_slip.hpp"
#include "support/catch.hpp"

using namespace flotsam;

namespace {

constexpr double kSpacing = 0.01, kGravity = 9.81;
const double kSpeed = std::sqrt(kGravity * kSpacing), kTime = std::sqrt(kSpacing / kGravity);

/// A ring of particles that touch a body about the origin (owner 1; owner 0 is a wall that they touch as well).
struct Ring {
    FluidState fluid;
    Contacts contacts;
    std::vector<Vec3d> centers = {Vec3d::Zero(), Vec3d::Zero()};
    std::vector<Twist> twists = {Twist{}, Twist{}};
    RecentSlip slip;

    Ring()
    {
        constexpr int kCount = 24;
        contacts.start = {0, kCount, 2 * kCount};
        for (int owner = 0; owner < 2; ++owner)
            for (int i = 0; i < kCount; ++i) {
                const double angle = 2.0 * 3.14159265358979 * i / kCount;
                Vec6 row = Vec6::Zero();
                row[0] = static_cast<Scalar>(-std::cos(angle)), row[2] = static_cast<Scalar>(-std::sin(angle));
                contacts.particle.push_back(static_cast<std::uint32_t>(i));
                contacts.row.push_back(row);
                if (owner > 0) continue;
                fluid.position.emplace_back(static_cast<Scalar>(0.1 * std::cos(angle)), Scalar(0),
                                            static_cast<Scalar>(0.1 * std::sin(angle)), Scalar(0));
                fluid.velocity.emplace_back(Vec4::Zero());
            }
    }
    double after(double duration, double gravity = kGravity)
    {
        constexpr int kSteps = 100;
        for (int step = 0; step < kSteps; ++step)
            slip.update(duration / kSteps, kSpacing, gravity, fluid, contacts, 1, centers, twists, Workers(2));
        CHECK(slip.shares()[0] == 0);
        return static_cast<double>(slip.shares()[1]);
    }
    void flow(const Vec3d& velocity)
    {
        for (Vec4& v : fluid.velocity) v.head<3>() = velocity.cast<Scalar>();
    }
};

} // namespace

TEST_CASE("a body counts as moving once it moves fast enough, and for a while after", "[sph]")
{
    Ring ring;
    CHECK(ring.after(kTime) == 0.0);
    SECTION("it moves")
    {
        ring.twists[1].linear = Vec3d(0, 0, 0.11 * kSpeed);
    }
    SECTION("it turns")
    {
        ring.twists[1].angular = Vec3d(0, 1.1 * kSpeed, 0);
    }
    SECTION("the water moves")
    {
        ring.flow(Vec3d(0.11 * kSpeed, 0, 0));
    }
    CHECK(ring.after(0.01 * kTime) == 1.0);
    ring.twists[1] = Twist{};
    ring.flow(Vec3d::Zero());
    CHECK(ring.after(5.0 * kTime) > 0.3);
    CHECK(ring.after(20.0 * kTime) == 0.0);
}

TEST_CASE("slow bodies, and those in a steady current, count as being at rest", "[sph]")
{
    Ring ring;
    ring.twists[1].linear = Vec3d(0.02 * kSpeed, 0, 0);
    CHECK(ring.after(kTime) == 0.0);
    ring.flow(Vec3d(kSpeed, 0, 0));
    CHECK(ring.after(kTime) == 1.0);
    CHECK(ring.after(100.0 * kTime) == 0.0);
}

TEST_CASE("without gravity all bodies that water touches count as moving", "[sph]")
{
    Ring ring;
    CHECK(ring.after(kTime, 0.0) == 1.0);
    ring.contacts.start = {0, 24, 24};
    CHECK(ring.after(kTime, 0.0) == 0.0);
}
