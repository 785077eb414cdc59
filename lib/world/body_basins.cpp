#include "world/body_basins.hpp"

#include "world/next_to.hpp"

#include <algorithm>
#include <numeric>

namespace flotsam {
namespace {

constexpr double kBelowSurface = 1.0; ///< spacings: what is higher may be a film that runs somewhere else

} // namespace

BodyBasins::BodyBasins(std::span<const Vec4> position, const SelfPairs& pairs, double particle_spacing,
                       std::vector<std::vector<std::uint32_t>> touching)
    : position_(position), pairs_(pairs), spacing_(particle_spacing), touching_(std::move(touching)),
      upwards_(position.size())
{
    std::iota(upwards_.begin(), upwards_.end(), std::uint32_t(0));
    const auto lower = [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(position_[a].z(), a) < std::pair(position_[b].z(), b);
    };
    std::sort(upwards_.begin(), upwards_.end(), lower);
    for (std::vector<std::uint32_t>& particles : touching_) std::sort(particles.begin(), particles.end(), lower);
}

/// Joins the particles below a height with their neighbours there.
void BodyBasins::fill_up_to(double height)
{
    for (; filled_ < upwards_.size(); ++filled_) {
        const std::uint32_t i = upwards_[filled_];
        if (!(static_cast<double>(position_[i].z()) < height)) return;
        is_filled_[i] = 1;
        visit_next_to(position_, pairs_, spacing_, i, [&](std::uint32_t j) {
            if (is_filled_[j] != 0) waters_.join(i, j);
        });
    }
}

/// The waters that touch a body, as far as they are filled.
std::vector<std::size_t> BodyBasins::roots_at(std::size_t body)
{
    std::vector<std::size_t> roots;
    for (const std::uint32_t i : touching_[body]) {
        if (is_filled_[i] == 0) break; // the others are higher
        roots.push_back(waters_.find(i));
    }
    std::sort(roots.begin(), roots.end());
    roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
    return roots;
}

/// The water that most of the line is, as far as it is filled; none if none of it is.
std::vector<std::size_t> BodyBasins::roots_of(const SoundingLine& line)
{
    std::vector<std::size_t> roots;
    for (const std::uint32_t i : line.column)
        if (is_filled_[i] != 0) roots.push_back(waters_.find(i));
    if (roots.empty()) return roots;
    std::sort(roots.begin(), roots.end());
    return {roots[roots.size() / 2]};
}

/// Whether most of the line's water, as far as it is filled, is one of these: next to a thin wall it has some
/// of both sides.
bool BodyBasins::reaches(const SoundingLine& line, std::span<const std::size_t> roots)
{
    std::size_t all = 0, reached = 0;
    for (const std::uint32_t i : line.column) {
        if (is_filled_[i] == 0) continue;
        ++all;
        if (std::binary_search(roots.begin(), roots.end(), waters_.find(i))) ++reached;
    }
    return 2 * reached > all;
}

std::vector<std::vector<std::size_t>> BodyBasins::lines_of_bodies(const std::vector<SoundingLine>& lines)
{
    filled_ = 0;
    is_filled_.assign(position_.size(), 0);
    waters_.reset(position_.size());
    std::vector<std::size_t> rising(lines.size());
    std::iota(rising.begin(), rising.end(), std::size_t(0));
    std::sort(rising.begin(), rising.end(), [&](std::size_t a, std::size_t b) {
        return std::pair(lines[a].level, a) < std::pair(lines[b].level, b);
    });
    std::vector<std::vector<std::size_t>> found(touching_.size());
    std::vector<std::vector<char>> hangs; // by place in `rising`: the higher lines that hang together with that one
    for (std::size_t at = 0; at < rising.size(); ++at) {
        const SoundingLine& lowest = lines[rising[at]];
        fill_up_to(lowest.level - kBelowSurface * spacing_);
        const auto higher = std::span(rising).subspan(at);
        const auto reached_by = [&](std::span<const std::size_t> roots) {
            std::vector<char> is_reached(lines.size(), 0);
            for (const std::size_t line : higher) is_reached[line] = reaches(lines[line], roots) ? 1 : 0;
            return is_reached;
        };
        hangs.push_back(reached_by(roots_of(lowest)));
        bool is_left = false;
        for (std::size_t body = 0; body < touching_.size(); ++body) {
            if (!found[body].empty() || touching_[body].empty()) continue;
            const std::vector<std::size_t> roots = roots_at(body);
            is_left = true;
            if (!reaches(lowest, roots)) continue;
            const std::vector<char> is_reached = reached_by(roots);
            for (std::size_t line = 0; line < lines.size(); ++line)
                if (is_reached[line] != 0) found[body].push_back(line);
            add_lower(std::span(rising).first(at), hangs, found[body]);
        }
        if (!is_left) break;
    }
    return found;
}

/// Adds the lines that were below all water that touches the body: those that hang together with most of its lines. (A
/// line over falling water hangs together with what is below and what is above a dam.)
void BodyBasins::add_lower(std::span<const std::size_t> lower, const std::vector<std::vector<char>>& hangs,
                           std::vector<std::size_t>& lines_of_body)
{
    const std::size_t count = lines_of_body.size();
    for (std::size_t at = 0; at < lower.size(); ++at) {
        const auto together =
            std::count_if(lines_of_body.begin(), lines_of_body.begin() + static_cast<std::ptrdiff_t>(count),
                          [&](std::size_t line) { return hangs[at][line] != 0; });
        if (2 * static_cast<std::size_t>(together) > count) lines_of_body.push_back(lower[at]);
    }
}

} // namespace flotsam
