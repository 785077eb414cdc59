#include "bullet/constrained_motion.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

/// Of a row's own term, in the matrix that is factorised. Four contacts under a box have one normal too many, and
/// targets that differ by rounding: without it they would fight each other with any impulse.
constexpr double kRegularisation = 1e-3;
/// Solutions with it, each with the rest of the one before: what the rows agree on comes out to 1e-9, what they
/// contradict each other in stays small.
constexpr int kRefinements = 3;

Vec6d stacked(const Wrench& wrench)
{
    Vec6d v;
    v << wrench.linear, wrench.angular;
    return v;
}

Vec6d stacked(const Twist& twist)
{
    Vec6d v;
    v << twist.linear, twist.angular;
    return v;
}

Twist twist_of(const Vec6d& v)
{
    return {v.head<3>(), v.tail<3>()};
}

} // namespace

void ConstrainedMotion::clear()
{
    free_.clear();
    predicted_.clear();
    groups_.clear();
    group_of_.clear();
    mobility_.clear();
    pool_.clear();
    rows_.clear();
    parts_.clear();
    first_part_.assign(1, 0);
    own_.clear();
    for (auto& parts : parts_of_group_) parts.clear();
    held_index_.clear();
    held_.clear();
    bound_scale_ = 1.0;
}

int ConstrainedMotion::add_bodies(std::span<const Twist> free, const Eigen::Ref<const Eigen::MatrixXd>& mobility)
{
    FLOTSAM_ASSERT(mobility.rows() == mobility.cols() && mobility.rows() == static_cast<Eigen::Index>(6 * free.size()),
                   "6 rows and columns a body");
    const std::size_t first = free_.size();
    free_.insert(free_.end(), free.begin(), free.end());
    predicted_.insert(predicted_.end(), free.begin(), free.end());
    group_of_.insert(group_of_.end(), free.size(), groups_.size());
    groups_.push_back({first, free.size(), mobility_.size()});
    const Eigen::Index n = mobility.rows();
    for (Eigen::Index column = 0; column < n; ++column)
        for (Eigen::Index row = 0; row < n; ++row) mobility_.push_back(mobility(row, column));
    if (parts_of_group_.size() < groups_.size()) parts_of_group_.emplace_back();
    return static_cast<int>(first);
}

int ConstrainedMotion::add_body(const Twist& free, const Mat6d& mobility)
{
    return add_bodies(std::span(&free, 1), mobility);
}

int ConstrainedMotion::add_row(const ConstraintRow& row)
{
    const std::size_t number = rows_.size();
    rows_.push_back(row);
    add_part(number, row.a, row.jacobian_a);
    add_part(number, row.b, row.jacobian_b);
    double own = 0.0;
    for (std::size_t p = first_part_.back(); p < parts_.size(); ++p) {
        Part& part = parts_[p];
        const Group& group = groups_[part.group];
        part.answer = pool_.size();
        pool_.resize(pool_.size() + static_cast<std::size_t>(group.size()));
        const Eigen::Map<const Eigen::MatrixXd> mobility(mobility_.data() + group.mobility, group.size(), group.size());
        Eigen::Map<Vector>(pool_.data() + part.answer, group.size()).noalias() = mobility * of(part.jacobian, group);
        own += of(part.jacobian, group).dot(of(part.answer, group));
        parts_of_group_[part.group].push_back(p);
    }
    rows_.back().cfm += row.relative_cfm * own;
    first_part_.push_back(parts_.size());
    own_.push_back(own);
    return static_cast<int>(number);
}

void ConstrainedMotion::add_part(std::size_t row, int body, const Vec6d& jacobian)
{
    if (body < 0) return;
    const std::size_t group = group_of_[static_cast<std::size_t>(body)];
    const Group& shared = groups_[group];
    std::size_t p = first_part_.back();
    while (p < parts_.size() && parts_[p].group != group) ++p;
    if (p == parts_.size()) {
        parts_.push_back({row, group, pool_.size(), 0});
        pool_.resize(pool_.size() + static_cast<std::size_t>(shared.size()), 0.0);
    }
    const std::size_t at = parts_[p].jacobian + 6 * (static_cast<std::size_t>(body) - shared.first);
    Eigen::Map<Vec6d>(pool_.data() + at) += jacobian;
}

double ConstrainedMotion::normal_impulse(const ConstraintRow& row) const
{
    double sum = 0.0;
    for (int k = 0; k < row.normals; ++k) sum += rows_[static_cast<std::size_t>(row.normal + k)].impulse;
    return std::max(0.0, sum);
}

double ConstrainedMotion::lower(const ConstraintRow& row) const
{
    return row.normal < 0 ? bound_scale_ * row.lower : -row.friction * normal_impulse(row);
}

double ConstrainedMotion::upper(const ConstraintRow& row) const
{
    return row.normal < 0 ? bound_scale_ * row.upper : row.friction * normal_impulse(row);
}

double ConstrainedMotion::rate(std::size_t row, const Vector& v) const
{
    double sum = 0.0;
    for (std::size_t p = first_part_[row]; p < first_part_[row + 1]; ++p) {
        const Group& group = groups_[parts_[p].group];
        sum += of(parts_[p].jacobian, group).dot(v.segment(static_cast<Eigen::Index>(6 * group.first), group.size()));
    }
    return sum;
}

void ConstrainedMotion::push(std::size_t row, double impulse, Vector& v) const
{
    for (std::size_t p = first_part_[row]; p < first_part_[row + 1]; ++p) {
        const Group& group = groups_[parts_[p].group];
        v.segment(static_cast<Eigen::Index>(6 * group.first), group.size()) += impulse * of(parts_[p].answer, group);
    }
}

void ConstrainedMotion::add_answers(std::span<const Wrench> impulses, Vector& v) const
{
    for (const Group& group : groups_) {
        for (std::size_t k = 0; k < group.count; ++k) {
            const Vec6d impulse = stacked(impulses[group.first + k]);
            if (impulse.isZero(0.0)) continue;
            const Eigen::Map<const Eigen::MatrixXd> mobility(mobility_.data() + group.mobility, group.size(),
                                                             group.size());
            v.segment(static_cast<Eigen::Index>(6 * group.first), group.size()).noalias() +=
                mobility.middleCols<6>(static_cast<Eigen::Index>(6 * k)) * impulse;
        }
    }
}

void ConstrainedMotion::free_velocity(Vector& v) const
{
    v.resize(static_cast<Eigen::Index>(6 * free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) v.segment<6>(static_cast<Eigen::Index>(6 * k)) = stacked(free_[k]);
}

bool ConstrainedMotion::solve(std::span<const Wrench> impulses, double tolerance)
{
    constexpr int kRounds = 12, kSweeps = 40;
    bool is_right = true;
    if (!rows_.empty()) {
        held_index_.assign(rows_.size(), -1);
        is_right = false;
        for (int round = 0; round < kRounds && !is_right; ++round) {
            clamp_impulses(impulses, velocity_);
            for (int k = 0; k < kSweeps; ++k) sweep(velocity_);
            choose_held();
            factorize();
            is_right = holds(impulses, tolerance);
        }
    }
    predict();
    return is_right;
}

/// Puts the rows' impulses into their bounds, and sets v to the velocities with them.
void ConstrainedMotion::clamp_impulses(std::span<const Wrench> impulses, Vector& v)
{
    free_velocity(v);
    add_answers(impulses, v);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        ConstraintRow& row = rows_[k];
        row.impulse = std::clamp(row.impulse, lower(row), upper(row));
        if (row.impulse != 0.0) push(k, row.impulse, v);
    }
}

/// One of projected Gauss-Seidel; returns the largest change of a row's rate.
double ConstrainedMotion::sweep(Vector& v)
{
    double largest = 0.0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        ConstraintRow& row = rows_[k];
        if (!(own_[k] + row.cfm > 0.0)) continue;
        const double rest = row.target - rate(k, v) - row.cfm * row.impulse;
        const double next = std::clamp(row.impulse + rest / (own_[k] + row.cfm), lower(row), upper(row));
        if (next != row.impulse) push(k, next - row.impulse, v);
        largest = std::max(largest, own_[k] * std::abs(next - row.impulse));
        row.impulse = next;
    }
    return largest;
}

void ConstrainedMotion::choose_held()
{
    held_.clear();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const ConstraintRow& row = rows_[k];
        const bool holds = own_[k] + row.cfm > 0.0 && row.impulse > lower(row) && row.impulse < upper(row);
        held_index_[k] = holds ? static_cast<int>(held_.size()) : -1;
        if (holds) held_.push_back(k);
    }
}

void ConstrainedMotion::factorize()
{
    entries_.clear();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const std::vector<std::size_t>& parts = parts_of_group_[g];
        for (const std::size_t p : parts) {
            const int column = held_index_[parts_[p].row];
            if (column < 0) continue;
            for (const std::size_t q : parts) {
                const int row = held_index_[parts_[q].row];
                if (row < column) continue; // the lower half; -1 too
                entries_.emplace_back(row, column,
                                      of(parts_[q].jacobian, groups_[g]).dot(of(parts_[p].answer, groups_[g])));
            }
        }
    }
    for (std::size_t h = 0; h < held_.size(); ++h)
        entries_.emplace_back(static_cast<int>(h), static_cast<int>(h),
                              rows_[held_[h]].cfm + kRegularisation * own_[held_[h]]);
    const auto n = static_cast<Eigen::Index>(held_.size());
    if (n == 0) return;
    Eigen::SparseMatrix<double> system(n, n);
    system.setFromTriplets(entries_.begin(), entries_.end());
    factor_.compute(system);
    FLOTSAM_ASSERT(factor_.info() == Eigen::Success, "the rows' matrix is positive definite once regularised");
}

/// On entry `v` is without the impulses of the rows that hold; on return with them. impulse_ holds them.
void ConstrainedMotion::solve_held(Vector& v)
{
    rest_.resize(static_cast<Eigen::Index>(held_.size()));
    for (std::size_t h = 0; h < held_.size(); ++h)
        rest_[static_cast<Eigen::Index>(h)] = rows_[held_[h]].target - rate(held_[h], v);
    impulse_ = held_impulses(rest_);
    for (std::size_t h = 0; h < held_.size(); ++h) push(held_[h], impulse_[static_cast<Eigen::Index>(h)], v);
}

/// (J Y J^T + cfm)^-1 rest of the rows that hold, for one or several columns; symmetric.
template <class Columns>
Columns ConstrainedMotion::held_impulses(const Columns& rest) const
{
    Columns found = factor_.solve(rest);
    for (int k = 1; k < kRefinements; ++k) {
        Columns more = rest;
        for (std::size_t h = 0; h < held_.size(); ++h)
            more.row(static_cast<Eigen::Index>(h)) +=
                kRegularisation * own_[held_[h]] * found.row(static_cast<Eigen::Index>(h));
        found = factor_.solve(more);
    }
    return found;
}

bool ConstrainedMotion::holds(std::span<const Wrench> impulses, double tolerance)
{
    constexpr int kSweeps = 20;
    if (rows_.empty()) return true;
    free_velocity(velocity_);
    add_answers(impulses, velocity_);
    for (std::size_t k = 0; k < rows_.size(); ++k)
        if (!is_held(k) && rows_[k].impulse != 0.0) push(k, rows_[k].impulse, velocity_);
    if (!held_.empty()) solve_held(velocity_);
    for (std::size_t h = 0; h < held_.size(); ++h) rows_[held_[h]].impulse = impulse_[static_cast<Eigen::Index>(h)];
    if (is_complementary(velocity_, tolerance)) return true;
    // Other impulses may do the same within the bounds.
    clamp_impulses(impulses, swept_);
    for (int k = 0; k < kSweeps; ++k)
        if (sweep(swept_) < 0.1 * tolerance) break;
    return (swept_ - velocity_).cwiseAbs().maxCoeff() <= tolerance;
}

/// Whether the impulses are within their bounds and the rows at a bound would stay there.
bool ConstrainedMotion::is_complementary(const Vector& v, double tolerance) const
{
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const ConstraintRow& row = rows_[k];
        if (!(own_[k] + row.cfm > 0.0)) continue;
        const double rest = is_held(k) ? 0.0 : row.target - rate(k, v) - row.cfm * row.impulse;
        const double better = std::clamp(row.impulse + rest / (own_[k] + row.cfm), lower(row), upper(row));
        if (std::abs(better - row.impulse) * own_[k] > tolerance) return false;
    }
    return true;
}

void ConstrainedMotion::predict()
{
    free_velocity(velocity_);
    for (std::size_t k = 0; k < rows_.size(); ++k)
        if (!is_held(k) && rows_[k].impulse != 0.0) push(k, rows_[k].impulse, velocity_);
    if (!held_.empty()) solve_held(velocity_);
    for (std::size_t k = 0; k < free_.size(); ++k)
        predicted_[k] = twist_of(velocity_.segment<6>(static_cast<Eigen::Index>(6 * k)));
}

void ConstrainedMotion::respond(std::span<const Wrench> impulses, std::span<Twist> twists) const
{
    FLOTSAM_ASSERT(impulses.size() == bodies() && twists.size() == bodies(), "one entry per body");
    velocity_.setZero(static_cast<Eigen::Index>(6 * bodies()));
    add_answers(impulses, velocity_);
    if (!held_.empty()) {
        rest_.resize(static_cast<Eigen::Index>(held_.size()));
        for (std::size_t h = 0; h < held_.size(); ++h) rest_[static_cast<Eigen::Index>(h)] = -rate(held_[h], velocity_);
        impulse_ = held_impulses(rest_);
        for (std::size_t h = 0; h < held_.size(); ++h)
            push(held_[h], impulse_[static_cast<Eigen::Index>(h)], velocity_);
    }
    for (std::size_t k = 0; k < bodies(); ++k)
        twists[k] = twist_of(velocity_.segment<6>(static_cast<Eigen::Index>(6 * k)));
}

Mat6d ConstrainedMotion::own_mobility(std::size_t body) const
{
    const std::size_t g = group_of_[body];
    const Group& group = groups_[g];
    const Eigen::Map<const Eigen::MatrixXd> mobility(mobility_.data() + group.mobility, group.size(), group.size());
    const auto at = static_cast<Eigen::Index>(6 * (body - group.first));
    Mat6d own = mobility.block<6, 6>(at, at);
    if (held_.empty()) return own;
    Eigen::Matrix<double, Eigen::Dynamic, 6> answers =
        Eigen::Matrix<double, Eigen::Dynamic, 6>::Zero(static_cast<Eigen::Index>(held_.size()), 6);
    bool any = false;
    for (const std::size_t p : parts_of_group_[g]) {
        const int h = held_index_[parts_[p].row];
        if (h < 0) continue;
        any = true;
        answers.row(h) = of(parts_[p].answer, group).segment<6>(at).transpose();
    }
    if (!any) return own;
    own -= answers.transpose() * held_impulses(answers);
    return 0.5 * (own + own.transpose());
}

} // namespace flotsam
