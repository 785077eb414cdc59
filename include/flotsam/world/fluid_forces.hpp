#pragma once

#include "flotsam/core/types.hpp"

namespace flotsam {

/// A value for each cause that something passes between the fluid and a solid.
template <class Value>
struct ByCause {
    Value pressure{}; ///< of the pressure solve, hydrostatic part and all
    Value viscous{};
    Value packing{}; ///< of packing_relief: takes away what a strained packing adds to the pressure
    Value guard{};   ///< of the wall guard: particles that it stopped

    [[nodiscard]] Value total() const
    {
        Value sum = pressure;
        sum += viscous;
        sum += packing;
        sum += guard;
        return sum;
    }
    ByCause& operator+=(const ByCause& other)
    {
        pressure += other.pressure;
        viscous += other.viscous;
        packing += other.packing;
        guard += other.guard;
        return *this;
    }
};

/// Forces [N] and torques [N m] of the fluid on a body by cause, means over the last step. World frame.
struct FluidForces {
    Wrench hydrostatic; ///< weight of the water displaced, through the centre of buoyancy
    Wrench dynamic;     ///< what the pressure does beside it: of waves, of motion, of added mass, and the noise
    Wrench viscous;
    Wrench packing; ///< of packing_relief: takes away what the strained packing adds to the pressure of a moving body
    Wrench guard;   ///< of the wall guard: particles that it stopped

    [[nodiscard]] Wrench pressure() const { return hydrostatic + dynamic; }
    [[nodiscard]] Wrench total() const { return hydrostatic + dynamic + viscous + packing + guard; }
};

/// What the pressure does at one boundary sample of a body, mean over the last step.
struct SampleForce {
    Vec3d position = Vec3d::Zero(); ///< of the sample, about half a spacing under the surface [m], world frame
    Vec3d force = Vec3d::Zero();    ///< [N], world frame
};

} // namespace flotsam
