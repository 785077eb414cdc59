#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
#include "support/box_mesh.hpp"
#include "support/catch.hpp"
#include "world/wall_guard.hpp"

#include <numbers>
#include <random>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.04;

/// Numbers and directions that repeat.
class Dice {
  public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double number(double from, double to)
    {
        return from + (to - from) * (static_cast<double>(engine_()) / 4294967295.0);
    }
    Vec3d in(const Aabb& box)
    {
        const double x = number(box.min.x(), box.max.x()), y = number(box.min.y(), box.max.y());
        return {x, y, number(box.min.z(), box.max.z())};
    }
    Vec3d direction()
    {
        while (true) {
            const Vec3d v = in({Vec3d(-1, -1, -1), Vec3d(1, 1, 1)});
            if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
        }
    }

  private:
    std::mt19937 engine_;
};

TriangleMesh torus(double radius, double tube)
{
    constexpr int kAround = 32, kTube = 16;
    TriangleMesh mesh;
    for (int i = 0; i < kAround; ++i) {
        for (int j = 0; j < kTube; ++j) {
            const double u = 2.0 * std::numbers::pi * i / kAround, v = 2.0 * std::numbers::pi * j / kTube;
            const double r = radius + tube * std::cos(v);
            mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
        }
    }
    const auto at = [](int i, int j) { return (i % kAround) * kTube + j % kTube; };
    for (int i = 0; i < kAround; ++i) {
        for (int j = 0; j < kTube; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

/// The rectangle x = 0, |y|, |z| <= half: 2 triangles without thickness.
TriangleMesh sheet(double half)
{
    TriangleMesh mesh;
    mesh.vertices = {Vec3d(0, -half, -half), Vec3d(0, half, -half), Vec3d(0, half, half), Vec3d(0, -half, half)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// A world with particles in it that do not touch each other, all thrown with one velocity.
struct Throw {
    Throw() : fluid(settings()) {}
    static FluidWorldSettings settings()
    {
        FluidWorldSettings s;
        s.particle_spacing = kSpacing;
        s.gravity = Vec3d::Zero();
        s.kinematic_viscosity = 0.0;
        s.max_time_step = 0.02;
        s.threads = 1;
        return s;
    }
    /// Steps of up to dt (a particle may fly 25 spacings in one), with the momenta compared in each.
    void fly(double dt, int steps)
    {
        NoBodies none;
        Vec3d before = Vec3d::Zero();
        fluid.prepare(none);
        for (const Vec4& v : fluid.fluid().velocity) before += v.head<3>().cast<double>();
        before *= fluid.fluid().particle_mass;
        for (int k = 0; k < steps; ++k) {
            const StepReport report = fluid.step(dt, none);
            stopped += report.leaks_stopped;
            leaked += report.leaked;
            error = std::max(error, (before - report.fluid_momentum - report.wall_impulse).norm());
            given += report.wall_impulse.norm();
            guard += report.guard_impulse;
            wall += report.wall_impulse;
            before = report.fluid_momentum;
        }
    }
    template <class Inside>
    [[nodiscard]] int count(Inside&& inside) const
    {
        int n = 0;
        for (const Vec4& p : fluid.fluid().position) n += inside(Vec3d(p.head<3>().cast<double>())) ? 1 : 0;
        return n;
    }

    FluidWorld fluid;
    int stopped = 0, leaked = 0;
    double error = 0.0, given = 0.0; ///< of the momentum balance, and the impulses that it is made of [N s]
    Vec3d guard = Vec3d::Zero(), wall = Vec3d::Zero();
};

void check_throw(const Throw& thrown, int thrown_at_least)
{
    REQUIRE(thrown.stopped >= thrown_at_least); // something was hit
    CHECK(thrown.leaked == 0);
    // Velocities are floats: rounding of some 100 of them, against a few that hit.
    CHECK(thrown.error < 1e-5 * thrown.given);
}

} // namespace

TEST_CASE("no particle is thrown out of a container", "[walls][property]")
{ // 4 containers, 3 directions, 50 particles
    const int shape = GENERATE(range(0, 4));
    const int seed = GENERATE(range(0, 3));
    Dice dice(static_cast<unsigned>(100 * shape + seed));
    const Aabb box{Vec3d(-0.3, -0.25, -0.2), Vec3d(0.3, 0.25, 0.2)};
    Throw thrown;
    TriangleMesh mesh;
    if (shape == 0) thrown.fluid.add_box_wall(box);
    if (shape == 1) thrown.fluid.add_wall(mesh = box_mesh(box), WallSide::inside);
    if (shape == 2) thrown.fluid.add_wall(mesh = tessellate(SphereShape{0.3}, 0.05), WallSide::inside);
    if (shape == 3) thrown.fluid.add_wall(mesh = torus(0.3, 0.1), WallSide::inside);
    const SurfaceQuery query(shape == 0 ? box_mesh(box) : mesh);
    std::vector<Vec3d> particles;
    while (particles.size() < 50) {
        const Vec3d p = dice.in(query.bounds());
        if (query.signed_distance(p) < -0.1 * kSpacing) particles.push_back(p);
    }
    thrown.fluid.add_particles(particles, dice.number(5.0, 50.0) * dice.direction());
    thrown.fly(0.02, 3);
    CAPTURE(shape, seed, thrown.stopped);
    CHECK(thrown.count([&](const Vec3d& p) { return query.inside(p); }) == 50);
    check_throw(thrown, 25);
}

TEST_CASE("no particle is thrown into a corner of a container and out of it", "[walls][property]")
{ // 8 corners and 12 edges, 50 particles each: the rounding of one wall's stop must not open another
    const int corner = GENERATE(range(0, 20));
    Dice dice(static_cast<unsigned>(corner));
    const Aabb box{Vec3d(-0.3, -0.25, -0.2), Vec3d(0.3, 0.25, 0.2)};
    const auto sign = [&](int axis) {
        if (corner < 8) return (corner >> axis) & 1 ? 1.0 : -1.0;
        const int edge = corner - 8; // the axis edge % 3 along, two signs
        if (edge % 3 == axis) return 0.0;
        return (edge / 3 >> ((axis + 3 - edge % 3) % 3 - 1)) & 1 ? 1.0 : -1.0;
    };
    const Vec3d toward(sign(0), sign(1), sign(2));
    Throw thrown;
    thrown.fluid.add_box_wall(box);
    std::vector<Vec3d> particles;
    for (int k = 0; k < 50; ++k) particles.push_back(dice.in(box.inflated(-0.001)));
    thrown.fluid.add_particles(particles, dice.number(5.0, 50.0) * (toward + 0.1 * dice.direction()).normalized());
    thrown.fly(0.02, 4);
    CAPTURE(corner, thrown.stopped);
    CHECK(thrown.count([&](const Vec3d& p) { return box.contains(p); }) == 50);
    check_throw(thrown, 25);
}

TEST_CASE("no particle is thrown through a wall thinner than a particle", "[walls][property]")
{ // in a container: a sheet, a plate of 0.2 d and a mesh plate of 0.01 d keep the left from the right
    const int wall = GENERATE(range(0, 3));
    const int seed = GENERATE(range(0, 4));
    Dice dice(static_cast<unsigned>(100 * wall + seed));
    const double half = wall == 1 ? 0.1 * kSpacing : 0.005 * kSpacing;
    Throw thrown;
    thrown.fluid.add_box_wall({Vec3d(-0.2, -0.2, -0.2), Vec3d(0.2, 0.2, 0.2)});
    if (wall == 0) thrown.fluid.add_wall(sheet(0.3), WallSide::both);
    if (wall > 0) {
        thrown.fluid.add_wall(box_mesh({Vec3d(-half, -0.3, -0.3), Vec3d(half, 0.3, 0.3)}), WallSide::outside);
    }
    std::vector<Vec3d> particles;
    for (int k = 0; k < 50; ++k) {
        Vec3d p = dice.in({Vec3d(0.01, -0.19, -0.19), Vec3d(0.19, 0.19, 0.19)});
        if (k >= 25) p.x() = -p.x();
        particles.push_back(p);
    }
    Vec3d way = dice.direction();
    way.x() += seed % 2 == 0 ? 1.0 : -1.0; // toward the wall for half of them
    thrown.fluid.add_particles(particles, dice.number(5.0, 50.0) * way.normalized());
    thrown.fly(0.02, 3);
    CAPTURE(wall, seed, thrown.stopped);
    int wrong = 0;
    const FluidState& fluid = thrown.fluid.fluid();
    for (std::size_t i = 0; i < fluid.size(); ++i) {
        const double x = static_cast<double>(fluid.position[i].x());
        const double side = fluid.id[i] < 25 ? 1.0 : -1.0;
        if (!(side * x > 0.0)) ++wrong;
    }
    CHECK(wrong == 0);
    check_throw(thrown, 25);
}

TEST_CASE("no particle is thrown into a solid obstacle", "[walls][property]")
{
    const int shape = GENERATE(range(0, 3));
    const int seed = GENERATE(range(0, 2));
    Dice dice(static_cast<unsigned>(100 * shape + seed));
    const Aabb room{Vec3d(-0.4, -0.4, -0.4), Vec3d(0.4, 0.4, 0.4)};
    const TriangleMesh mesh = shape == 0   ? box_mesh({Vec3d(-0.2, -0.15, -0.1), Vec3d(0.2, 0.15, 0.1)})
                              : shape == 1 ? tessellate(SphereShape{0.25}, 0.05)
                                           : torus(0.25, 0.1);
    const SurfaceQuery query(mesh);
    Throw thrown;
    thrown.fluid.add_box_wall(room);
    thrown.fluid.add_wall(mesh, WallSide::outside);
    std::vector<Vec3d> particles;
    while (particles.size() < 50) {
        const Vec3d p = dice.in(room);
        if (query.signed_distance(p) > 0.1 * kSpacing) particles.push_back(p);
    }
    thrown.fluid.add_particles(particles, dice.number(5.0, 50.0) * dice.direction());
    thrown.fly(0.02, 3);
    CAPTURE(shape, seed, thrown.stopped);
    CHECK(thrown.count([&](const Vec3d& p) { return query.inside(p); }) == 0);
    CHECK(thrown.count([&](const Vec3d& p) { return room.contains(p); }) == 50);
    check_throw(thrown, 25);
}

TEST_CASE("the guard alone gives the walls what it takes from the particles", "[walls][property]")
{
    const SurfaceQuery ring(torus(0.3, 0.1)), plate(sheet(0.5));
    const Workers workers(1);
    WallGuard guard;
    guard.build({{&ring, true, false}, {&plate, true, true}}, kSpacing, workers);
    Dice dice(7);
    std::vector<Vec4> from, to, velocity, before, straight;
    std::vector<GuardedMotion> motion(2);
    const double dt = 0.01, mass = 0.008;
    while (from.size() < 1000) {
        const Vec3d p = dice.in(ring.bounds());
        if (ring.signed_distance(p) > -0.1 * kSpacing || std::abs(p.x()) < 1e-4) continue;
        const Vec3d v = dice.number(1.0, 50.0) * dice.direction();
        Vec4 start = Vec4::Zero(), speed = Vec4::Zero();
        start.head<3>() = p.cast<Scalar>();
        speed.head<3>() = v.cast<Scalar>();
        from.push_back(start);
        velocity.push_back(speed);
        to.push_back(start + static_cast<Scalar>(dt) * speed);
    }
    before = velocity;
    straight = to;
    std::vector<Wrench> impulses(2);
    const GuardReport report = guard.stop(from, to, velocity, motion, mass, workers, nullptr, impulses);
    CHECK(report.stopped > 500);
    CHECK(report.leaked == 0);
    Vec3d lost = Vec3d::Zero();
    Vec3d turning_lost = Vec3d::Zero();
    double given = 0.0;
    int out = 0, through = 0; // of the ring, the plate that cuts it in half
    for (std::size_t i = 0; i < from.size(); ++i) {
        const Vec3d part = mass * (before[i] - velocity[i]).head<3>().cast<double>();
        lost += part;
        turning_lost += mass * (straight[i].head<3>().cross(before[i].head<3>()).cast<double>() -
                                to[i].head<3>().cross(velocity[i].head<3>()).cast<double>());
        given += part.norm();
        out += ring.inside(to[i].head<3>().cast<double>()) ? 0 : 1;
        through += from[i].x() * to[i].x() > 0 ? 0 : 1;
        CHECK(velocity[i].norm() <= before[i].norm() * 1.000001f); // stopping takes energy only
    }
    CHECK(out == 0);
    CHECK(impulses[1].linear.norm() > 0.0); // some hit the plate
    CHECK((lost - impulses[0].linear - impulses[1].linear).norm() < 1e-6 * given);
    CHECK((turning_lost - impulses[0].angular - impulses[1].angular).norm() < 1e-6 * given); // arms below a metre
    CHECK(through == 0);
}

TEST_CASE("a body that closes on a wall pushes no particle through it", "[walls][property]")
{ // 50 particles in the gap, which closes all but for a rounding error, or wholly
    const double gap = GENERATE(0.0, 1e-9, 1e-5);
    CAPTURE(gap);
    Dice dice(11);
    const TriangleMesh tank = box_mesh({Vec3d(-1, -1, 0), Vec3d(1, 1, 1)});
    const TriangleMesh cube = tessellate(BoxShape{Vec3d::Constant(0.4)}, 1.0);
    const SurfaceQuery tank_query(tank), cube_query(cube);
    const Workers workers(1);
    WallGuard guard;
    guard.build({{&tank_query, true, false}, {&cube_query, false, true}}, kSpacing, workers);

    constexpr double kStep = 0.002;
    std::vector<GuardedMotion> motion(2);
    motion[1].before.position = Vec3d(0, 0, 0.2 + 0.1 * kSpacing);
    motion[1].after.position = Vec3d(0, 0, 0.2 + gap);
    motion[1].twist.linear = (motion[1].after.position - motion[1].before.position) / kStep;
    std::vector<Vec4> from, velocity(50, Vec4(1, -1, 0, 0));
    while (from.size() < velocity.size()) {
        const Vec3d at = dice.in({Vec3d(-0.15, -0.15, 0.01 * kSpacing), Vec3d(0.15, 0.15, 0.09 * kSpacing)});
        from.emplace_back(static_cast<Scalar>(at.x()), static_cast<Scalar>(at.y()), static_cast<Scalar>(at.z()), 0.0f);
    }
    std::vector<Vec4> to = from;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += static_cast<Scalar>(kStep) * velocity[i];
    std::vector<Wrench> impulses(2);
    const GuardReport report = guard.stop(from, to, velocity, motion, 1.0, workers, nullptr, impulses);
    CHECK(report.stopped == 50);
    CHECK(report.leaked == 0);
    for (const Vec4& p : to) CHECK(p[2] > 0);
}

TEST_CASE("a body that is lighter than what strikes it takes up no energy from nothing", "[walls][property]")
{ // 20 particles on one face, of 1e-3 to 1e3 times the body's mass all together
    const double ratio = GENERATE(1e-3, 0.1, 1.0, 10.0, 1e3);
    CAPTURE(ratio);
    Dice dice(5);
    const TriangleMesh cube = tessellate(BoxShape{Vec3d::Constant(0.4)}, 1.0);
    const SurfaceQuery query(cube);
    const Workers workers(1);
    WallGuard guard;
    guard.build({{&query, false, true}}, kSpacing, workers);
    constexpr double kMass = 0.064, kStep = 0.002;
    const double body_mass = 20.0 * kMass / ratio, inertia = body_mass * 0.16 / 6.0;
    const Twist drift{Vec3d(0.3, 0, 0.1), Vec3d(0, 0.5, 0)};
    std::vector<GuardedMotion> motion(1);
    motion[0].twist = drift;
    motion[0].after.position = kStep * drift.linear;
    motion[0].after.orientation = Quatd(Eigen::AngleAxisd(kStep * drift.angular.y(), Vec3d::UnitY()));
    std::vector<Vec4> from, velocity(20, Vec4(0.2f, 0, -4, 0));
    while (from.size() < velocity.size()) {
        const Vec3d at = dice.in({Vec3d(-0.15, -0.15, 0.201), Vec3d(0.15, 0.15, 0.204)});
        from.emplace_back(static_cast<Scalar>(at.x()), static_cast<Scalar>(at.y()), static_cast<Scalar>(at.z()), 0.0f);
    }
    std::vector<Vec4> to = from;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += static_cast<Scalar>(kStep) * velocity[i];
    const auto sum = [&](auto&& term) {
        Vec3d total = Vec3d::Zero();
        for (std::size_t i = 0; i < to.size(); ++i)
            total += kMass * term(Vec3d(to[i].head<3>().cast<double>()), Vec3d(velocity[i].head<3>().cast<double>()));
        return total;
    };
    const auto linear = [&] { return sum([](const Vec3d&, const Vec3d& v) { return v; }); };
    const auto angular = [&] { return sum([](const Vec3d& at, const Vec3d& v) { return Vec3d(at.cross(v)); }); };
    const auto energy = [&](const Twist& twist) {
        const Vec3d particles = sum([](const Vec3d&, const Vec3d& v) { return Vec3d(0.5 * v.squaredNorm(), 0, 0); });
        return particles.x() + 0.5 * body_mass * twist.linear.squaredNorm() +
               0.5 * inertia * twist.angular.squaredNorm();
    };
    const Vec3d linear_before = linear(), angular_before = angular();
    const double energy_before = energy(drift);
    const auto answer = [&](std::span<const Wrench> impulses, std::span<Twist> changes) {
        changes[0] = {impulses[0].linear / body_mass, impulses[0].angular / inertia};
    };
    const WallGuard::Response response = answer;
    std::vector<Wrench> impulses(1);
    const GuardReport report = guard.stop(from, to, velocity, motion, kMass, workers, &response, impulses);
    CHECK(report.stopped == 20);
    const Twist after{drift.linear + impulses[0].linear / body_mass, drift.angular + impulses[0].angular / inertia};
    const double scale = 20.0 * kMass * 4.0;
    CHECK((linear_before - linear() - impulses[0].linear).norm() < 1e-5 * scale);
    CHECK((angular_before - angular() - impulses[0].angular).norm() < 1e-5 * scale);
    CHECK(energy(after) < 1.01 * energy_before); // a little: it gets the angular momentum that putting them back takes
    CHECK(after.linear.norm() < 4.2);            // of the particles
    CHECK(impulses[0].linear.z() < 0.0);
}
