#include "flotsam/sph/density.hpp"
#include "flotsam/sph/kernel.hpp"
#include "sph/pressure/complementarity_solver.hpp"
#include "sph/pressure/response_preconditioner.hpp"
#include "support/catch.hpp"

#include <random>

using namespace flotsam;

namespace {

/// A random cloud at about rest density with one free owner of samples in its middle and one that stands still.
struct Cloud {
    static constexpr double kSpacing = 0.1, kRho0 = 1000.0;
    double mass = kRho0 * kSpacing * kSpacing * kSpacing;
    double body_mass;
    Workers workers{1};
    std::vector<Vec4> points;
    BoundaryState boundary;
    std::vector<Vec3d> centers{Vec3d(0.1, 0.2, 0.3), Vec3d(0.35, 0.35, 0.35)};
    SelfPairs pairs;
    Pairs boundary_pairs;
    Contacts contacts;
    std::vector<Scalar> density;
    PressureSystem::Scratch scratch;
    std::vector<Vec4> unknowns, own_gradient;

    KernelKind kernel_kind;

    explicit Cloud(double of_body, KernelKind kind = KernelKind::quintic) : body_mass(of_body), kernel_kind(kind)
    {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> jitter(-0.25, 0.25);
        const auto point = [&](int x, int y, int z) -> Vec3d {
            return Vec3d(x + jitter(random), y + jitter(random), z + jitter(random)) * kSpacing;
        };
        for (int x = 0; x < 8; ++x) {
            for (int y = 0; y < 8; ++y) {
                for (int z = 0; z < 8; ++z) {
                    const bool body = x > 2 && x < 5 && y > 2 && y < 5 && z > 2 && z < 5;
                    const bool wall = z == 0;
                    Vec4 p = Vec4::Zero();
                    p.head<3>() = point(x, y, z).cast<Scalar>();
                    if (!body && !wall) {
                        points.push_back(p);
                        continue;
                    }
                    boundary.position.push_back(p);
                    boundary.volume.push_back(Scalar(1.2 * kSpacing * kSpacing * kSpacing));
                    boundary.velocity.push_back(Vec4::Zero());
                    boundary.owner.push_back(body ? 1 : 0);
                }
            }
        }
        refresh();
    }

    void refresh()
    {
        const Kernel kernel(kernel_kind, kSpacing, 3);
        const double support = static_cast<double>(kernel.support());
        const CellGrid grid = CellGrid::around(points, boundary.position, support, 100000);
        CellLists cells, boundary_cells;
        cells.build(grid, points, workers);
        boundary_cells.build(grid, boundary.position, workers);
        NeighbourSearch search;
        kernel.visit([&](const auto& spline) {
            search.find(spline, grid, cells, points, workers, pairs);
            search.find(spline, grid, boundary_cells, points, false, boundary.volume, workers, boundary_pairs);
        });
        ContactBuilder().build(boundary_pairs, points, boundary, centers, kRho0, workers, contacts);
        density.resize(points.size());
        compute_density(pairs.kernel_sum, boundary_pairs.kernel_sum, kernel.value(0), mass, kRho0, workers, density);
    }

    [[nodiscard]] PressureSystem system()
    {
        return {pairs, points, contacts, mass, workers, scratch, {&unknowns, &own_gradient}};
    }
    void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const
    {
        const double inertia = 0.4 * body_mass * 0.01;
        twists[0] = {};
        twists[1] = {impulses[1].linear / body_mass, impulses[1].angular / inertia};
    }
    [[nodiscard]] std::vector<Eigen::Matrix<double, 6, 6>> mobility() const
    {
        Eigen::Matrix<double, 6, 1> y;
        y << Vec3d::Constant(1.0 / body_mass), Vec3d::Constant(1.0 / (0.4 * body_mass * 0.01));
        return {Eigen::Matrix<double, 6, 6>::Zero(), y.asDiagonal()};
    }
};

std::vector<Scalar> random_values(std::size_t n, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<Scalar> value(-1, 1);
    std::vector<Scalar> values(n);
    for (Scalar& v : values) v = value(random);
    return values;
}

double dot(std::span<const Scalar> a, std::span<const Scalar> b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    return sum;
}

} // namespace

TEST_CASE("density rate is the derivative of the density", "[sph][pressure][derivative]")
{
    Cloud cloud(5.0);
    const std::size_t n = cloud.points.size();
    const PressureSystem system = cloud.system();
    std::vector<Vec4> velocity(n, Vec4::Zero());
    const std::vector<Scalar> raw = random_values(3 * n, 6);
    for (std::size_t i = 0; i < n; ++i) velocity[i] = Vec4(raw[3 * i], raw[3 * i + 1], raw[3 * i + 2], 0);
    const std::vector<Twist> twists = {{}, {Vec3d(0.5, -0.3, 0.8), Vec3d(2.0, 1.0, -3.0)}};
    std::vector<Scalar> rate(n);
    system.density_rate(velocity, twists, rate);

    const std::vector<Vec4> start = cloud.points, samples = cloud.boundary.position;
    const auto moved = [&](double t) {
        for (std::size_t i = 0; i < n; ++i) cloud.points[i] = start[i] + static_cast<Scalar>(t) * velocity[i];
        for (std::size_t b = 0; b < samples.size(); ++b) {
            const Vec3d arm = samples[b].head<3>().cast<double>() - cloud.centers[1];
            if (cloud.boundary.owner[b] == 1) {
                cloud.boundary.position[b].head<3>() = samples[b].head<3>() + (t * twists[1].at(arm)).cast<Scalar>();
            }
        }
        cloud.refresh();
        return cloud.density;
    };
    const double dt = 2e-4; // a 500th of a spacing; float densities are good to 1e-7 of 1000
    const std::vector<Scalar> before = moved(-dt), after = moved(dt);
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double numeric = (static_cast<double>(after[i]) - static_cast<double>(before[i])) / (2.0 * dt);
        error += std::pow(numeric - static_cast<double>(rate[i]), 2);
        size += numeric * numeric;
    }
    REQUIRE(size > 0.0);
    CHECK(std::sqrt(error / size) < 5e-3);
}

TEST_CASE("the pressure operator is symmetric, positive and has the diagonal it says", "[sph][pressure][property]")
{
    const double body_mass = GENERATE(0.01, 5.0, 1e9);
    Cloud cloud(body_mass);
    const std::size_t n = cloud.points.size();
    const PressureSystem system = cloud.system();
    const auto answer = [&](std::span<const Wrench> w, std::span<Twist> t) { cloud.respond(w, t); };
    const OwnerResponse response = answer;
    PressureOperator op;
    op.bind(system, &response, 2);
    const std::vector<Scalar> x = random_values(n, 7), y = random_values(n, 8);
    std::vector<Scalar> ax(n), ay(n);
    op.apply(x, ax);
    op.apply(y, ay);
    CHECK(dot(y, ax) == Approx(dot(x, ay)).epsilon(1e-4));
    CHECK(dot(x, ax) > 0.0);

    std::vector<Scalar> fluid(n), bound(n);
    system.fluid_diagonal(fluid);
    bound = fluid;
    system.add_response_diagonal(cloud.mobility(), bound);
    PressureOperator without;
    without.bind(system, nullptr, 2);
    for (std::size_t i = 0; i < n; i += 17) {
        std::vector<Scalar> unit(n, 0), column(n);
        unit[i] = 1;
        op.apply(unit, column);
        CHECK(bound[i] >= column[i] * Scalar(0.999));
        without.apply(unit, column);
        CHECK(static_cast<double>(column[i]) == Approx(static_cast<double>(fluid[i])).epsilon(1e-4));
    }
}

TEST_CASE("pressure impulses change no momentum of fluid and bodies together", "[sph][pressure][property]")
{
    Cloud cloud(3.0);
    const std::size_t n = cloud.points.size();
    const PressureSystem system = cloud.system();
    std::vector<Scalar> x = random_values(n, 9);
    for (Scalar& v : x) v = std::abs(v);
    std::vector<Vec4> dv(n);
    std::vector<Wrench> impulses(2);
    system.velocity_change(x, dv);
    system.impulses(x, impulses);
    Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();
    double given = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d p = cloud.mass * dv[i].head<3>().cast<double>();
        linear += p;
        angular += cloud.points[i].head<3>().cast<double>().cross(p);
        given += p.norm();
    }
    for (std::size_t k = 0; k < 2; ++k) {
        linear += impulses[k].linear;
        angular += impulses[k].angular + cloud.centers[k].cross(impulses[k].linear);
    }
    REQUIRE(impulses[1].linear.norm() > 1e-3 * given);
    CHECK(linear.norm() < 1e-5 * given);
    CHECK(angular.norm() < 1e-5 * given);
}

TEST_CASE("the response's preconditioner inverts the fluid's diagonal and the bodies' answer", "[sph][pressure]")
{
    Cloud cloud(GENERATE(0.01, 5.0));
    const std::size_t n = cloud.points.size();
    const PressureSystem system = cloud.system();
    const auto answer = [&](std::span<const Wrench> w, std::span<Twist> t) { cloud.respond(w, t); };
    const OwnerResponse response = answer;
    PressureOperator with, without;
    with.bind(system, &response, 2);
    without.bind(system, nullptr, 2);
    std::vector<Scalar> diagonal(n), free(n, 1), z(n), all(n), fluid(n);
    for (std::size_t i = 0; i < n; i += 3) free[i] = 0;
    system.fluid_diagonal(diagonal);
    ResponsePreconditioner preconditioner;
    preconditioner.build(system, cloud.mobility(), diagonal);
    const std::vector<Scalar> g = random_values(n, 11);
    preconditioner.apply(free, g, z);
    with.apply(z, all);
    without.apply(z, fluid);
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        if (free[i] == Scalar(0)) {
            CHECK(z[i] == Scalar(0));
            continue;
        }
        const double made = static_cast<double>(diagonal[i]) * static_cast<double>(z[i]) + static_cast<double>(all[i]) -
                            static_cast<double>(fluid[i]);
        error += std::pow(made - static_cast<double>(g[i]), 2);
        size += std::pow(static_cast<double>(g[i]), 2);
    }
    CHECK(std::sqrt(error / size) < 1e-3);
}

TEST_CASE("a body a millionth as heavy costs the Krylov method at most three times the iterations", "[sph][pressure]")
{
    const auto iterations = [](double body_mass) {
        Cloud cloud(body_mass);
        const std::size_t n = cloud.points.size();
        const PressureSystem system = cloud.system();
        const auto answer = [&](std::span<const Wrench> w, std::span<Twist> t) { cloud.respond(w, t); };
        const OwnerResponse response = answer;
        std::vector<Scalar> diagonal(n), b(n), x(n, 0);
        for (std::size_t i = 0; i < n; ++i) b[i] = cloud.density[i] - Scalar(0.97 * Cloud::kRho0);
        system.fluid_diagonal(diagonal);
        ResponsePreconditioner preconditioner;
        preconditioner.build(system, cloud.mobility(), diagonal);
        system.add_response_diagonal(cloud.mobility(), diagonal);
        PressureOperator op;
        op.bind(system, &response, 2);
        op.set_preconditioner(&preconditioner);
        SolveGoal goal;
        goal.scale = 1.0 / Cloud::kRho0;
        goal.tolerance = 1e-4;
        const SolveResult result = Mprgp().solve(op, b, diagonal, goal, x);
        CHECK(result.converged);
        return result.iterations;
    };
    CHECK(iterations(5e-6) <= 3 * iterations(5.0));
}

TEST_CASE("all solvers find the same pressures, also with a light body", "[sph][pressure]")
{
    const double body_mass = GENERATE(0.05, 5.0);
    Cloud cloud(body_mass, GENERATE(KernelKind::quintic, KernelKind::cubic));
    const std::size_t n = cloud.points.size();
    const PressureSystem system = cloud.system();
    const auto answer = [&](std::span<const Wrench> w, std::span<Twist> t) { cloud.respond(w, t); };
    const OwnerResponse response = answer;
    PressureOperator op;
    op.bind(system, &response, 2);
    std::vector<Scalar> diagonal(n), b(n);
    for (std::size_t i = 0; i < n; ++i) b[i] = cloud.density[i] - Scalar(0.97 * Cloud::kRho0);
    SolveGoal goal;
    goal.scale = 1.0 / Cloud::kRho0;
    goal.tolerance = 2e-6;
    goal.max_iterations = 20000;

    std::vector<Scalar> jacobi(n, 0), krylov(n, 0), spectral(n, 0);
    system.fluid_diagonal(diagonal);
    system.add_response_diagonal(cloud.mobility(), diagonal);
    const SolveResult a = RelaxedJacobi().solve(op, b, diagonal, goal, jacobi);
    REQUIRE(a.converged);
    ResponsePreconditioner preconditioner;
    std::vector<Scalar> fluid_diagonal(n);
    system.fluid_diagonal(fluid_diagonal);
    preconditioner.build(system, cloud.mobility(), fluid_diagonal);
    op.set_preconditioner(&preconditioner);
    const SolveResult c = Mprgp().solve(op, b, diagonal, goal, krylov);
    REQUIRE(c.converged);
    CHECK(c.iterations < a.iterations);
    const SolveResult g = SpectralGradient().solve(op, b, diagonal, goal, spectral);
    REQUIRE(g.converged);
    CHECK(g.products < a.products);
    // Pressures differ along near-null directions; what they do must not.
    std::vector<Scalar> made_a(n), made(n);
    op.apply(jacobi, made_a);
    for (const std::vector<Scalar>* found : {&krylov, &spectral}) {
        op.apply(*found, made);
        double difference = 0.0, size = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            CHECK((*found)[i] >= Scalar(0));
            difference += std::abs(static_cast<double>(made_a[i]) - static_cast<double>(made[i]));
            size += std::abs(static_cast<double>(made_a[i]));
        }
        REQUIRE(size > 0.0);
        CHECK(difference < 0.01 * size);
    }
}

TEST_CASE("the largest eigenvalue bounds the quotient of any vector but for a few per cent", "[sph][pressure]")
{
    Cloud cloud(0.5, GENERATE(KernelKind::quintic, KernelKind::cubic));
    const std::size_t n = cloud.points.size();
    const PressureSystem system = cloud.system();
    PressureOperator op;
    op.bind(system, nullptr, 2);
    std::vector<Scalar> diagonal(n), x = random_values(n, 11), ax(n);
    system.fluid_diagonal(diagonal);
    double largest = 0.0; // brute force: many iterations of D^-1 A
    for (int k = 0; k < 300; ++k) {
        op.apply(x, ax);
        double weighted = 0.0;
        for (std::size_t i = 0; i < n; ++i)
            weighted += static_cast<double>(x[i]) * static_cast<double>(x[i]) * static_cast<double>(diagonal[i]);
        largest = dot(x, ax) / weighted;
        for (std::size_t i = 0; i < n; ++i) x[i] = ax[i] / diagonal[i] * Scalar(1.0 / largest);
    }
    LargestEigenvalue estimate;
    const double first = estimate.of(op, diagonal);
    CHECK(first > 0.75 * largest); // so that 1.5 / first stays below the 2 / largest at which Jacobi diverges
    CHECK(first < 1.001 * largest);
    const double second = estimate.of(op, diagonal); // goes on from where the first ended
    CHECK(second >= first * 0.999);
    CHECK(second < 1.001 * largest);
}
