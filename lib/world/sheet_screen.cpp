#include "world/sheet_screen.hpp"

#include <algorithm>
#include <atomic>

namespace flotsam {
namespace {

constexpr double kSlack = 0.02; ///< of the support radius: lengths that are taken for 0

std::span<const std::uint32_t> row(const Pairs& pairs, std::size_t i)
{
    return std::span(pairs.index).subspan(pairs.start[i], pairs.start[i + 1] - pairs.start[i]);
}

SheetView placed_view(const SheetScreen::Placed& placed, const Vec4& point, double reach)
{
    SheetView view = placed.sheet.view_from(placed.pose.to_body(point.head<3>().cast<double>()), reach);
    view.place = placed.pose.to_world(view.place);
    view.normal = placed.pose.orientation * view.normal;
    return view;
}

SheetView view_of_own_sample(const BoundaryState& boundary, std::uint32_t b)
{
    SheetView view;
    view.normal = boundary.normal[b].head<3>().cast<double>();
    view.place =
        boundary.position[b].head<3>().cast<double>() + static_cast<double>(boundary.normal[b][3]) * view.normal;
    view.side = static_cast<int>(boundary.normal_body[b][3]);
    return view;
}

} // namespace

void SheetScreen::Near::number_points()
{
    points.clear();
    number.assign(is_near.size(), -1);
    for (std::size_t k = 0; k < is_near.size(); ++k) {
        if (is_near[k] == 0) continue;
        number[k] = static_cast<std::int32_t>(points.size());
        points.push_back(static_cast<std::uint32_t>(k));
    }
    views.resize(points.size());
}

/// Particles with a sample of the sheet in reach, and all samples in reach of those.
void SheetScreen::find_near(std::int32_t owner, std::size_t particles, const BoundaryState& boundary,
                            const Workers& workers, const Pairs& boundary_pairs)
{
    fluid_.is_near.assign(particles, 0);
    samples_.is_near.assign(boundary.size(), 0);
    workers.for_each(particles, [&](std::size_t i) {
        const auto samples = row(boundary_pairs, i);
        if (std::none_of(samples.begin(), samples.end(), [&](std::uint32_t b) { return boundary.owner[b] == owner; }))
            return;
        fluid_.is_near[i] = 1;
        for (const std::uint32_t b : samples) std::atomic_ref(samples_.is_near[b]).store(1, std::memory_order_relaxed);
    });
    fluid_.number_points();
    samples_.number_points();
}

void SheetScreen::hide(const Placed& placed, const Kernel& kernel, std::span<const Vec4> position,
                       const BoundaryState& boundary, const Workers& workers, SelfPairs& fluid_pairs,
                       Pairs& boundary_pairs)
{
    const auto owner = static_cast<std::int32_t>(placed.owner);
    find_near(owner, position.size(), boundary, workers, boundary_pairs);
    const double support = static_cast<double>(kernel.support()), slack = kSlack * support, reach = 2.0 * support;
    workers.for_each(fluid_.points.size(),
                     [&](std::size_t k) { fluid_.views[k] = placed_view(placed, position[fluid_.points[k]], reach); });
    workers.for_each(samples_.points.size(), [&](std::size_t k) {
        const std::uint32_t b = samples_.points[k];
        samples_.views[k] = boundary.owner[b] == owner ? view_of_own_sample(boundary, b)
                                                       : placed_view(placed, boundary.position[b], reach);
    });
    // What is seen of another point: all, and of what the sheet hides as much as the two are beyond its rim.
    const auto seen = [&](const SheetView& a, const SheetView& b) {
        return on_one_side(a, b, slack) ? 1.0 : 1.0 - (1.0 - a.beyond_rim) * (1.0 - b.beyond_rim);
    };
    const auto seen_of_own = [&](const SheetView& view, const SheetView& sample) {
        const double in_front = on_one_side(view, sample, slack) ? 1.0 - view.beyond_rim : 0.0;
        return in_front + view.beyond_rim * placed.rim_weight;
    };
    const auto keep = [&](auto& pairs, std::size_t i, std::uint32_t k, double share, const Vec4& other, Scalar weight) {
        if (share == 1.0) return;
        const Scalar distance = (position[i] - other).head<3>().norm();
        pairs.kernel_sum[i] -= static_cast<Scalar>(1.0 - share) * weight * kernel.value(distance);
        pairs.keep(k, share);
    };
    workers.for_each(fluid_.points.size(), [&](std::size_t at) {
        const std::size_t i = fluid_.points[at];
        const SheetView& view = fluid_.views[at];
        if (!view.is_near()) return;
        for (std::uint32_t k = fluid_pairs.start[i]; k < fluid_pairs.start[i + 1]; ++k) {
            const std::uint32_t j = fluid_pairs.neighbour(i, k);
            const SheetView* other = fluid_.view_of(j);
            if (other != nullptr && other->is_near()) keep(fluid_pairs, i, k, seen(view, *other), position[j], 1);
        }
        for (std::uint32_t k = boundary_pairs.start[i]; k < boundary_pairs.start[i + 1]; ++k) {
            const std::uint32_t b = boundary_pairs.index[k];
            const SheetView& other = *samples_.view_of(b);
            if (!other.is_near()) continue;
            const double share = boundary.owner[b] == owner ? seen_of_own(view, other) : seen(view, other);
            keep(boundary_pairs, i, k, share, boundary.position[b], boundary.volume[b]);
        }
        // What is left of sums that were taken away wholly is rounding.
        fluid_pairs.kernel_sum[i] = std::max(fluid_pairs.kernel_sum[i], Scalar(0));
        boundary_pairs.kernel_sum[i] = std::max(boundary_pairs.kernel_sum[i], Scalar(0));
    });
}

} // namespace flotsam
