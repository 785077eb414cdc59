#include "geometry/blue_noise.hpp"

#include "geometry/point_grid.hpp"

#include <algorithm>
#include <cstdint>
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

/// Binary heap of indices whose weights only sink, the heaviest on top; equal weights go by index.
class CrowdHeap {
  public:
    explicit CrowdHeap(std::vector<double> weights)
        : weights_(std::move(weights)), heap_(weights_.size()), place_(weights_.size())
    {
        std::iota(heap_.begin(), heap_.end(), std::uint32_t{0});
        std::sort(heap_.begin(), heap_.end(), [&](std::uint32_t i, std::uint32_t j) { return before(i, j); });
        for (std::size_t k = 0; k < heap_.size(); ++k) place_[heap_[k]] = static_cast<std::uint32_t>(k);
    }
    std::uint32_t pop()
    {
        const std::uint32_t top = heap_.front();
        place_[top] = kGone;
        const std::uint32_t last = heap_.back();
        heap_.pop_back();
        if (!heap_.empty()) {
            put(last, 0);
            sink(0);
        }
        return top;
    }
    void lighten(std::uint32_t i, double by)
    {
        if (place_[i] == kGone) return;
        weights_[i] -= by;
        sink(place_[i]);
    }
    [[nodiscard]] std::vector<std::size_t> rest() const
    {
        std::vector<std::size_t> sorted(heap_.begin(), heap_.end());
        std::sort(sorted.begin(), sorted.end());
        return sorted;
    }
    [[nodiscard]] std::size_t size() const { return heap_.size(); }

  private:
    static constexpr std::uint32_t kGone = static_cast<std::uint32_t>(-1);

    [[nodiscard]] bool before(std::uint32_t i, std::uint32_t j) const
    {
        return weights_[i] != weights_[j] ? weights_[i] > weights_[j] : i < j;
    }
    void put(std::uint32_t i, std::size_t k)
    {
        heap_[k] = i;
        place_[i] = static_cast<std::uint32_t>(k);
    }
    void sink(std::size_t k)
    {
        const std::uint32_t i = heap_[k];
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
    std::vector<std::uint32_t> heap_, place_;
};

} // namespace

std::vector<std::size_t> eliminate_crowded(std::span<const Vec3d> points, std::size_t fixed, std::size_t count,
                                           double reach, const Workers& workers)
{
    std::vector<double> weights(points.size(), 0.0);
    // Who is near point i: count_near[i] of near[its chunk], from first[i] on.
    std::vector<std::vector<std::uint32_t>> near(Workers::chunk_count(points.size()));
    std::vector<std::uint32_t> first(points.size()), count_near(points.size());
    {
        const PointGrid grid(points, reach);
        workers.for_chunks(points.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                first[i] = static_cast<std::uint32_t>(near[chunk].size());
                grid.for_near(points[i], reach, [&](std::size_t j, double distance_sq) {
                    if (j == i) return;
                    near[chunk].push_back(static_cast<std::uint32_t>(j));
                    weights[i] += crowding(distance_sq, reach);
                });
                count_near[i] = static_cast<std::uint32_t>(near[chunk].size()) - first[i];
            }
            near[chunk].shrink_to_fit();
        });
    }
    for (std::size_t i = 0; i < fixed; ++i) weights[i] = -std::numeric_limits<double>::infinity();
    CrowdHeap heap(std::move(weights));
    while (heap.size() > std::max(count, fixed)) {
        const std::uint32_t gone = heap.pop();
        const std::uint32_t* others = near[gone / Workers::kChunk].data() + first[gone];
        for (std::uint32_t k = 0; k < count_near[gone]; ++k)
            heap.lighten(others[k], crowding((points[others[k]] - points[gone]).squaredNorm(), reach));
    }
    return heap.rest();
}

} // namespace flotsam
