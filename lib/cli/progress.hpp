#pragma once

#include "flotsam/scene/run_scene.hpp"

#include <iosfwd>

namespace flotsam::cli {

/// Prints how a run goes on: a bar that is redrawn on a terminal, else a line every tenth of the run; before it, the
/// same of how its water comes to rest where it starts so.
class Progress final : public RunObserver {
  public:
    Progress(std::ostream& out, bool is_terminal) : out_(out), is_terminal_(is_terminal) {}

    void on_settle(const SettleProgress& progress) override;
    void on_start(std::size_t fluid_particles, std::size_t boundary_samples,
                  const std::vector<std::string>& notes) override;
    void on_step(const RunProgress& progress) override;

  private:
    void draw_bar(const RunProgress& progress);

    std::ostream& out_;
    bool is_terminal_;
    double next_draw_ = 0.1; ///< seconds on a terminal, else a fraction of the run
};

} // namespace flotsam::cli
