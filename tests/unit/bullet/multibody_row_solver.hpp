#pragma once

#include "bullet/free_motion.hpp"
#include "bullet/multibody_rows.hpp"
#include "multibody_scene.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam::test {

inline constexpr double kStep = 0.004;
/// A link held by six rows of its own multibody takes thousands.
inline constexpr int kSweeps = 20000;
/// Both solvers iterate; relative to speeds of some m/s.
inline constexpr double kSolved = sizeof(btScalar) == 8 ? 1e-7 : 1e-2;

/// Rows of all constraints of a scene, solved by projected Gauss-Seidel, to be compared with Bullet's own step.
class RowSolver {
  public:
    RowSolver(MultibodyScene& scene, Random& random) : scene_(scene), random_(random)
    {
        scene.world.getSolverInfo().m_numIterations = kSweeps;
        scene.world.getSolverInfo().m_leastSquaresResidualThreshold = btScalar(1e-24);
        for (int k = 0; k < scene.world.getNumMultibodies(); ++k) motions_.emplace_back(*scene.world.getMultiBody(k));
    }
    /// Random impulses on the links, the rows, and what they make of twists.
    void predict()
    {
        for (MultibodyMotion& motion : motions_) {
            motion.read(kStep, scene_.gravity, false);
            const std::vector<Wrench> impulses = random_impulses(motion.size(), random_);
            twists_.push_back(twists_of(motion, motion.predicted_joint_velocity()));
            add(motion, impulses, twists_.back());
            motion.apply(impulses);
        }
        for (btRigidBody* body : rigid_bodies) rigid_twists_.push_back(free_motion(*body, kStep, 100).end);
        for (int k = 0; k < scene_.world.getNumMultiBodyConstraints(); ++k) {
            btMultiBodyConstraint& constraint = *scene_.world.getMultiBodyConstraint(k);
            REQUIRE(rows_of_.append(constraint, kStep, scene_.world.getSolverInfo(), rows));
            constraints_.resize(rows.size(), &constraint);
        }
        impulses_.assign(rows.size(), 0.0);
        double change = 1.0;
        for (int sweep = 0; sweep < kSweeps && change > 1e-12; ++sweep) {
            change = 0.0;
            for (std::size_t k = 0; k < rows.size(); ++k) change = std::max(change, solve(k));
        }
    }
    /// Steps Bullet and compares twists and impulses.
    void check()
    {
        scene_.step(kStep);
        for (std::size_t k = 0; k < motions_.size(); ++k) {
            const auto after = twists_of(motions_[k], joint_velocity(motions_[k].body()));
            for (std::size_t link = 0; link < after.size(); ++link)
                CHECK(difference(after[link], twists_[k][link]) < kSolved);
        }
        for (std::size_t k = 0; k < rigid_bodies.size(); ++k)
            CHECK(difference(velocity(*rigid_bodies[k]), rigid_twists_[k]) < kSolved);
        for (std::size_t k = 0; k < rows.size(); ++k)
            CHECK(row_force(*constraints_[k], rows[k].number, kStep) ==
                  Approx(impulses_[k] / kStep).epsilon(kSolved).margin(1e3 * kSolved));
    }
    [[nodiscard]] double velocity_of(const MultibodyRow& row)
    {
        return of_end(row.a, row.jacobian_a) + of_end(row.b, row.jacobian_b);
    }
    [[nodiscard]] double impulse(std::size_t row) const { return impulses_[row]; }

    std::vector<MultibodyRow> rows;
    std::vector<btRigidBody*> rigid_bodies;

  private:
    static void add(const MultibodyMotion& motion, const std::vector<Wrench>& impulses, std::vector<Twist>& twists)
    {
        std::vector<Twist> answer(impulses.size());
        motion.mobility().respond(impulses, answer);
        for (std::size_t k = 0; k < answer.size(); ++k) {
            twists[k].linear += answer[k].linear;
            twists[k].angular += answer[k].angular;
        }
    }
    std::size_t number_of(const btMultiBody* body) const
    {
        std::size_t k = 0;
        while (&motions_[k].body() != body) ++k;
        return k;
    }
    Twist* twist_of(const RowEnd& end)
    {
        if (end.multibody != nullptr) return &twists_[number_of(end.multibody)][static_cast<std::size_t>(end.link)];
        for (std::size_t k = 0; k < rigid_bodies.size(); ++k)
            if (rigid_bodies[k] == end.body) return &rigid_twists_[k];
        return nullptr;
    }
    double of_end(const RowEnd& end, const Vec6d& J)
    {
        const Twist* twist = twist_of(end);
        return twist == nullptr ? 0.0 : J.head<3>().dot(twist->linear) + J.tail<3>().dot(twist->angular);
    }
    void push(const RowEnd& end, const Vec6d& J, double impulse)
    {
        const Wrench wrench{J.head<3>() * impulse, J.tail<3>() * impulse};
        if (end.multibody != nullptr) {
            const std::size_t k = number_of(end.multibody);
            std::vector<Wrench> impulses(twists_[k].size());
            impulses[static_cast<std::size_t>(end.link)] = wrench;
            add(motions_[k], impulses, twists_[k]);
        } else if (Twist* twist = twist_of(end)) {
            const Twist answer = mobility_of(*end.body) * wrench;
            twist->linear += answer.linear;
            twist->angular += answer.angular;
        }
    }
    void push(const MultibodyRow& row, double impulse)
    {
        push(row.a, row.jacobian_a, impulse);
        push(row.b, row.jacobian_b, impulse);
    }
    /// Returns the change of the impulse, of its size.
    double solve(std::size_t k)
    {
        const MultibodyRow& row = rows[k];
        const double before = velocity_of(row);
        push(row, 1.0);
        const double own = velocity_of(row) - before + row.cfm;
        push(row, -1.0);
        const double wanted = impulses_[k] + (row.target - before - row.cfm * impulses_[k]) / own;
        const double given = std::clamp(wanted, row.lower, row.upper);
        const double change = given - impulses_[k];
        push(row, change);
        impulses_[k] = given;
        return std::abs(change) / (1.0 + std::abs(given));
    }

    MultibodyScene& scene_;
    Random& random_;
    MultibodyRows rows_of_;
    std::vector<MultibodyMotion> motions_;
    std::vector<std::vector<Twist>> twists_;
    std::vector<Twist> rigid_twists_;
    std::vector<btMultiBodyConstraint*> constraints_;
    std::vector<double> impulses_;
};

} // namespace flotsam::test
