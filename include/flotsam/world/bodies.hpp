#pragma once

#include "flotsam/core/types.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace flotsam {

/// One rigid body (or link) as the fluid sees it at the start of a step.
struct BodyState {
    Pose pose;             ///< of the centre-of-mass frame: position is the centre of mass
    Twist predicted;       ///< at the end of the step under gravity and applied forces, without the fluid
    bool responds = false; ///< dynamic; fixed and moving bodies move the water and are not moved by it
    Twist start{};         ///< at the start of the step: tells the ledger what work is done, packing_relief what moves
};

/// The bodies port: what the fluid needs from a rigid-body engine. World frame, SI units, wrenches and twists about
/// each body's centre of mass. Bodies are numbered 0 .. size() - 1 in the order in which they were given to the
/// FluidWorld.
class Bodies {
  public:
    virtual ~Bodies() = default;

    [[nodiscard]] virtual std::size_t size() const = 0;

    /// Fills `states` (one per body) for a step of `dt` seconds.
    virtual void read(double dt, std::span<BodyState> states) = 0;

    /// Twist change that these impulses alone cause: linear, symmetric, positive semi-definite; zero for bodies that do
    /// not respond. Bodies that joints or contacts hold together answer each other's. Must not change anything; called
    /// several times a step.
    virtual void respond(std::span<const Wrench> impulses, std::span<Twist> twists) const = 0;

    /// Answer of each body to impulses on itself, 6 x 6, linear part first. False: the fluid finds it by respond, which
    /// takes six calls a body.
    virtual bool own_mobility(std::span<Eigen::Matrix<double, 6, 6>>) const { return false; }

    /// After a pressure solve: whether impulses, all that the fluid gives in this step so far, make joints or contacts
    /// change between holding and yielding. If so, the states get new predictions (poses stay), respond answers by what
    /// holds now, and the solve is to be repeated. Engines without constraints, or that keep them from the fluid, leave
    /// it at false.
    virtual bool revise(std::span<const Wrench>, std::span<BodyState>) { return false; }

    /// Hands the impulses of the step over for good.
    virtual void apply(std::span<const Wrench> impulses) = 0;

    /// What the engine gives its bodies [m/s^2]; nothing where that is not known. A FluidWorld with another one notes
    /// it.
    [[nodiscard]] virtual std::optional<Vec3d> gravity() const { return std::nullopt; }
};

/// A world without bodies.
class NoBodies final : public Bodies {
  public:
    [[nodiscard]] std::size_t size() const override { return 0; }
    void read(double, std::span<BodyState>) override {}
    void respond(std::span<const Wrench>, std::span<Twist>) const override {}
    void apply(std::span<const Wrench>) override {}
};

/// Bodies that stand still, whatever pushes them.
class HeldBodies final : public Bodies {
  public:
    /// Of their centre-of-mass frames.
    explicit HeldBodies(std::vector<Pose> poses) : poses_(std::move(poses)) {}
    [[nodiscard]] std::size_t size() const override { return poses_.size(); }
    void read(double, std::span<BodyState> states) override
    {
        for (std::size_t k = 0; k < poses_.size(); ++k) states[k] = {poses_[k], Twist{}, false};
    }
    void respond(std::span<const Wrench>, std::span<Twist> twists) const override
    {
        std::fill(twists.begin(), twists.end(), Twist{});
    }
    void apply(std::span<const Wrench>) override {}

  private:
    std::vector<Pose> poses_;
};

} // namespace flotsam
