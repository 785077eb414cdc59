#include "geometry/pose_families.hpp"

#include "geometry/principal_axes.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

constexpr int kMostStrides = 360; ///< along a valley: around the body

/// The minima that level ways join to a neutral one.
class Family {
  public:
    Family(const FlotationSolver& solver, const std::vector<Minimum>& minima, const Attitude& seed)
        : solver_(solver), minima_(minima), seed_(seed), rise_(kNeutralRise * solver.size()), reach_(minima.size())
    {
        extend(seed);
        join();
        if (!is_any_left()) return;
        const Eigen::Vector2d axis = principal_axes(seed.curvature).axes[0];
        for (const Eigen::Vector2d& way : {axis, Eigen::Vector2d(-axis)})
            for (const Attitude& place : level_valley(solver, seed, way, kMostStrides)) extend(place);
        join();
    }
    [[nodiscard]] bool has(std::size_t minimum) const { return reach_[minimum].is_member; }

  private:
    /// How far a minimum is from the family.
    struct Reach {
        double angle = 1.2;   ///< from the nearest place [rad]; no farther, but a coarse ball has few minima
        std::size_t from = 0; ///< that place
        bool is_untried = false;
        bool is_member = false;
    };

    bool may_join(std::size_t k) const
    {
        return !reach_[k].is_member && std::abs(minima_[k].attitude.energy - seed_.energy) <= rise_;
    }
    bool is_any_left() const
    {
        for (std::size_t k = 0; k < minima_.size(); ++k)
            if (may_join(k)) return true;
        return false;
    }
    /// `place` belongs to the family.
    void extend(const Attitude& place)
    {
        for (std::size_t k = 0; k < minima_.size(); ++k) {
            const double angle = angle_between(place, minima_[k].attitude);
            if (may_join(k) && angle < reach_[k].angle) reach_[k] = {angle, places_.size(), true};
        }
        places_.push_back(place);
    }
    /// Tries each minimum from the place that is nearest to it, the nearest minimum first, so that a family that does
    /// not lie on a great circle is joined step by step.
    void join()
    {
        const auto is_before = [](const Reach& a, const Reach& b) {
            return a.is_untried != b.is_untried ? a.is_untried : a.angle < b.angle;
        };
        for (;;) {
            const auto nearest = std::ranges::min_element(reach_, is_before);
            if (!nearest->is_untried) return;
            nearest->is_untried = false;
            const Attitude& minimum = minima_[static_cast<std::size_t>(nearest - reach_.begin())].attitude;
            const auto [low, high] = std::minmax(seed_.energy, minimum.energy);
            if (!is_level_between(solver_, places_[nearest->from], minimum, low - rise_, high + rise_)) continue;
            nearest->is_member = true;
            extend(minimum);
        }
    }

    const FlotationSolver& solver_;
    const std::vector<Minimum>& minima_;
    const Attitude& seed_;
    double rise_;
    std::vector<Reach> reach_; ///< of each minimum
    std::vector<Attitude> places_;
};

} // namespace

std::vector<Minimum> lowest_of_families(const FlotationSolver& solver, std::vector<Minimum> minima)
{
    std::vector<char> is_joined(minima.size());
    for (std::size_t seed = 0; seed < minima.size(); ++seed) {
        if (is_joined[seed]) continue;
        const int neutral = neutral_directions(solver, minima[seed].attitude);
        if (neutral == 0) continue;
        const Family family(solver, minima, minima[seed].attitude);
        std::size_t lowest = seed; // or one before it, at the end of the valley
        for (std::size_t k = minima.size(); k-- > 0;) {
            if (!family.has(k)) continue;
            is_joined[k] = 1;
            lowest = std::min(lowest, k);
        }
        is_joined[lowest] = 0;
        minima[lowest].neutral_directions = neutral;
    }
    std::vector<Minimum> kept;
    for (std::size_t k = 0; k < minima.size(); ++k)
        if (!is_joined[k]) kept.push_back(minima[k]);
    return kept;
}

} // namespace flotsam
