#include "cli/progress.hpp"

#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace flotsam::cli {
namespace {

std::string duration_words(double seconds)
{
    const auto whole = static_cast<long>(std::lround(seconds));
    std::ostringstream text;
    if (whole >= 3600) text << whole / 3600 << " h ";
    if (whole >= 60) text << whole / 60 % 60 << " min ";
    text << whole % 60 << " s";
    return text.str();
}

/// Simulated time, how fast it goes, and what is left.
std::string state_words(const RunProgress& progress)
{
    const double factor = progress.time / std::max(progress.wall_seconds, 1e-9);
    const double left = (progress.duration - progress.time) / std::max(factor, 1e-9);
    std::ostringstream text;
    text << std::fixed << std::setprecision(2) << progress.time << " / " << progress.duration << " s simulated, "
         << std::setprecision(factor < 0.1 ? 4 : 2) << factor << " x real time, ";
    if (progress.time >= progress.duration * (1.0 - 1e-9))
        text << "took " << duration_words(progress.wall_seconds);
    else
        text << duration_words(left) << " left";
    return text.str();
}

std::string settle_words(const SettleProgress& progress)
{
    std::ostringstream text;
    text << std::fixed << std::setprecision(1) << "settling the water: round " << progress.rounds << " of at most "
         << progress.most_rounds << ", " << 1000.0 * progress.speed << " mm/s (at rest below "
         << 1000.0 * progress.still_speed << ")";
    return text.str();
}

} // namespace

void Progress::on_settle(const SettleProgress& progress)
{
    if (is_terminal_) {
        out_ << "\r" << settle_words(progress) << "\033[K" << std::flush;
        if (progress.is_last) out_ << std::endl;
    } else if (progress.is_last || progress.rounds % (progress.most_rounds / 10) == 0) {
        out_ << settle_words(progress) << std::endl;
    }
}

void Progress::on_start(std::size_t fluid_particles, std::size_t boundary_samples,
                        const std::vector<std::string>& notes)
{
    for (const std::string& note : notes) out_ << "note: " << note << "\n";
    out_ << fluid_particles << " fluid particles, " << boundary_samples << " boundary samples" << std::endl;
}

void Progress::on_step(const RunProgress& progress)
{
    const double fraction = progress.time / progress.duration;
    const bool is_done = fraction >= 1.0 - 1e-9;
    if (!is_done && (is_terminal_ ? progress.wall_seconds : fraction) < next_draw_) return;
    if (is_terminal_) {
        next_draw_ = progress.wall_seconds + 0.1;
        draw_bar(progress);
        if (is_done) out_ << std::endl;
        return;
    }
    next_draw_ = 0.1 * (std::floor(10.0 * fraction + 1e-9) + 1.0);
    out_ << std::setw(3) << std::lround(100.0 * fraction) << " %  " << state_words(progress) << std::endl;
}

void Progress::draw_bar(const RunProgress& progress)
{
    constexpr int kWidth = 24;
    const int done = static_cast<int>(std::min(1.0, progress.time / progress.duration) * kWidth);
    const std::string bar(static_cast<std::size_t>(done), '#');
    const std::string rest(static_cast<std::size_t>(kWidth - done), '.');
    out_ << "\r[" << bar << rest << "] " << state_words(progress) << "\033[K" << std::flush;
}

} // namespace flotsam::cli
