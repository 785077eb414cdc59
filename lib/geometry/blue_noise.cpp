#include "geometry/blue_noise.hpp"

#include "geometry/point_grid.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace flotsam {
namespace {

double crowding(double distance_sq, double reach)
{
    const double gap = 1.0 - std::sqrt(distance_sq) / reach;
    const double gap_sq = gap * gap, gap_4 = gap_sq * gap_sq;
    return gap_4 * gap_4;
}

/// A point near another one, and the weight that it gives it.
struct Crowder {
    std::size_t point;
    double weight;
};

/// Binary heap of indices whose weights only sink, the heaviest on top; equal weights go by index.
class CrowdHeap {
  public:
    explicit CrowdHeap(std::vector<double> weights)
        : weights_(std::move(weights)), heap_(weights_.size()), place_(weights_.size())
    {
        std::iota(heap_.begin(), heap_.end(), std::size_t{0});
        std::sort(heap_.begin(), heap_.end(), [&](std::size_t i, std::size_t j) { return before(i, j); });
        for (std::size_t k = 0; k < heap_.size(); ++k) place_[heap_[k]] = k;
    }
    std::size_t pop()
    {
        const std::size_t top = heap_.front();
        place_[top] = kGone;
        const std::size_t last = heap_.back();
        heap_.pop_back();
        if (!heap_.empty()) {
            put(last, 0);
            sink(0);
        }
        return top;
    }
    void lighten(std::size_t i, double by)
    {
        if (place_[i] == kGone) return;
        weights_[i] -= by;
        sink(place_[i]);
    }
    [[nodiscard]] std::vector<std::size_t> rest() const
    {
        std::vector<std::size_t> sorted = heap_;
        std::sort(sorted.begin(), sorted.end());
        return sorted;
    }
    [[nodiscard]] std::size_t size() const { return heap_.size(); }

  private:
    static constexpr std::size_t kGone = static_cast<std::size_t>(-1);

    [[nodiscard]] bool before(std::size_t i, std::size_t j) const
    {
        return weights_[i] != weights_[j] ? weights_[i] > weights_[j] : i < j;
    }
    void put(std::size_t i, std::size_t k)
    {
        heap_[k] = i;
        place_[i] = k;
    }
    void sink(std::size_t k)
    {
        const std::size_t i = heap_[k];
        for (;;) {
            std::size_t child = 2 * k + 1;
            if (child >= heap_.size()) break;
            if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
            if (!before(heap_[child], i)) break;
            put(heap_[child], k);
            k = child;
        }
        put(i, k);
    }

    std::vector<double> weights_;
    std::vector<std::size_t> heap_, place_;
};

} // namespace

std::vector<std::size_t> eliminate_crowded(std::span<const Vec3d> points, std::size_t fixed, std::size_t count,
                                           double reach, const Workers& workers)
{
    const PointGrid grid(points, reach);
    std::vector<std::vector<Crowder>> around(points.size());
    std::vector<double> weights(points.size(), 0.0);
    workers.for_each(points.size(), [&](std::size_t i) {
        grid.for_near(points[i], reach, [&](std::size_t j, double distance_sq) {
            if (j == i) return;
            around[i].push_back({j, crowding(distance_sq, reach)});
            weights[i] += around[i].back().weight;
        });
    });
    for (std::size_t i = 0; i < fixed; ++i) weights[i] = -std::numeric_limits<double>::infinity();
    CrowdHeap heap(std::move(weights));
    while (heap.size() > std::max(count, fixed)) {
        for (const Crowder& crowder : around[heap.pop()]) heap.lighten(crowder.point, crowder.weight);
    }
    return heap.rest();
}

} // namespace flotsam
