#pragma once

#include "flotsam/core/types.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <limits>
#include <span>
#include <vector>

namespace flotsam {

using Vec6d = Eigen::Matrix<double, 6, 1>; ///< linear part, then angular
using Mat6d = Eigen::Matrix<double, 6, 6>;

/// One scalar constraint between the twists of two bodies at the end of a step:  J v + cfm lambda = target  where the
/// impulse lambda lies between its bounds, <= target at the upper and >= target at the lower one.
struct ConstraintRow {
    int a = -1, b = -1; ///< bodies; -1: one that stands still or moves as it is told to
    Vec6d jacobian_a = Vec6d::Zero(), jacobian_b = Vec6d::Zero();
    double target = 0.0;       ///< [m/s] or [rad/s]
    double cfm = 0.0;          ///< compliance [1/kg] or the like, >= 0
    double relative_cfm = 0.0; ///< compliance to be added, as part of J Y J^T
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    int normal = -1;       ///< of a friction row: the first row of its contact, whose impulses bound this one's
    int normals = 0;       ///< and how many there are
    double friction = 0.0; ///< coefficient: |lambda| <= friction * sum of the contact's impulses
    double impulse = 0.0;  ///< a guess; then the answer [N s] or [N m s]
};

/// How bodies under joints and contacts move, and how they answer more impulses: their own mobility, and the
/// constraints of a rigid-body engine on top of it.
///
///     v = v_free + Y w + Y J^T lambda,   lambda in its bounds and complementary to  J v + cfm lambda - target
///
/// Contacts, limits and motors at their bound make that piecewise linear in the impulses w. solve() finds the piece for
/// one w: rows inside their bounds hold, those at a bound push with it. In it v is affine, and its linear part
///
///     respond(w) = (Y - Y J_h^T (J_h Y J_h^T + cfm)^-1 J_h Y) w
///
/// is symmetric and positive semi-definite, as the pressure system wants it. holds() tells whether the piece is still
/// the right one under other impulses; solving again when it is not makes the two a semi-smooth Newton iteration.
/// **Source:** for the piecewise linear problem: Stewart & Trinkle 1996 (contacts as a complementarity problem on
/// velocities); for its solution: projected Gauss-Seidel to find the set, then Hintermueller, Ito & Kunisch 2002
/// (primal-dual active sets). **Differs:** friction is a pyramid.
class ConstrainedMotion {
  public:
    void clear();

    /// Adds bodies that answer each other's impulses also without rows (links of one multibody): `mobility` is square,
    /// 6 rows a body, linear part first. Returns the number of the first.
    int add_bodies(std::span<const Twist> free, const Eigen::Ref<const Eigen::MatrixXd>& mobility);
    int add_body(const Twist& free, const Mat6d& mobility);
    /// Returns the row's number.
    int add_row(const ConstraintRow& row);

    [[nodiscard]] std::size_t bodies() const { return free_.size(); }
    [[nodiscard]] std::span<const ConstraintRow> rows() const { return rows_; }

    /// Replaces the twists without impulses and rows: another sub-step from the same poses.
    void set_free(std::size_t body, const Twist& free) { free_[body] = free; }
    /// Scales the bounds of the rows' impulses from then on: to a part of the step they are for.
    void scale_bounds(double factor) { bound_scale_ = factor; }

    /// Finds which rows hold under `impulses` (one per body), as far as velocities show it to `tolerance` [m/s]. False:
    /// not within its bound of iterations, so that the set is an approximation.
    bool solve(std::span<const Wrench> impulses, double tolerance);
    /// Whether the rows that hold under `impulses` are those of the last solve, as far as velocities show it to
    /// `tolerance`: different impulses in the rows do not count if the bodies move alike, since four contacts
    /// under one box can share its weight in many ways.
    [[nodiscard]] bool holds(std::span<const Wrench> impulses, double tolerance);

    /// The affine part: twists without impulses, as the rows that hold would have them.
    [[nodiscard]] std::span<const Twist> predicted() const { return predicted_; }
    /// The linear part.
    void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const;
    /// Block of the linear part that is body k's answer to itself.
    [[nodiscard]] Mat6d own_mobility(std::size_t body) const;

  private:
    /// Bodies that share a mobility; a free one is alone.
    struct Group {
        std::size_t first = 0, count = 1; ///< bodies
        std::size_t mobility = 0;         ///< offset in mobility_
        [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(6 * count); }
    };
    /// A row's part in one group: J and Y J^T, each as long as the group.
    struct Part {
        std::size_t row = 0, group = 0;
        std::size_t jacobian = 0, answer = 0; ///< offsets in pool_
    };
    using Vector = Eigen::VectorXd;
    using ConstMap = Eigen::Map<const Vector>;

    [[nodiscard]] ConstMap of(std::size_t offset, const Group& group) const
    {
        return {pool_.data() + offset, group.size()};
    }
    void add_part(std::size_t row, int body, const Vec6d& jacobian);
    [[nodiscard]] bool is_held(std::size_t row) const { return held_index_[row] >= 0; }
    [[nodiscard]] double lower(const ConstraintRow& row) const;
    [[nodiscard]] double upper(const ConstraintRow& row) const;
    [[nodiscard]] double rate(std::size_t row, const Vector& v) const; ///< J v
    void push(std::size_t row, double impulse, Vector& v) const;       ///< v += Y J^T impulse
    void add_answers(std::span<const Wrench> impulses, Vector& v) const;
    void free_velocity(Vector& v) const;
    [[nodiscard]] double normal_impulse(const ConstraintRow& row) const;
    void clamp_impulses(std::span<const Wrench> impulses, Vector& v);
    double sweep(Vector& v);
    [[nodiscard]] bool is_complementary(const Vector& v, double tolerance) const;
    void choose_held();
    void factorize();
    void solve_held(Vector& v);
    template <class Columns>
    [[nodiscard]] Columns held_impulses(const Columns& rest) const;
    void predict();

    std::vector<Twist> free_, predicted_;
    std::vector<Group> groups_;
    std::vector<std::size_t> group_of_; ///< of each body
    std::vector<double> mobility_, pool_;
    std::vector<ConstraintRow> rows_;
    std::vector<Part> parts_; ///< of row k: first_part_[k] .. first_part_[k + 1]
    std::vector<std::size_t> first_part_{0};
    std::vector<double> own_; ///< J Y J^T of each row
    std::vector<std::vector<std::size_t>> parts_of_group_;
    std::vector<int> held_index_; ///< of each row among those that hold, or -1
    std::vector<std::size_t> held_;
    std::vector<Eigen::Triplet<double>> entries_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
    mutable Vector velocity_, rest_, impulse_;
    Vector swept_;
    double bound_scale_ = 1.0;
};

} // namespace flotsam
