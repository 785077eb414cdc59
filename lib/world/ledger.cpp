#include "flotsam/world/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {

FluidTotals& FluidTotals::operator+=(const FluidTotals& other)
{
    momentum += other.momentum;
    angular_momentum += other.angular_momentum;
    kinetic += other.kinetic;
    potential += other.potential;
    volume += other.volume;
    return *this;
}

FluidTotals FluidTotals::operator-(const FluidTotals& other) const
{
    return {momentum - other.momentum, angular_momentum - other.angular_momentum, kinetic - other.kinetic,
            potential - other.potential, volume - other.volume};
}

EnergyLedger& EnergyLedger::operator+=(const EnergyLedger& other)
{
    gravity += other.gravity;
    walls += other.walls;
    bodies += other.bodies;
    viscous += other.viscous;
    compression += other.compression;
    guard += other.guard;
    shift += other.shift;
    integration += other.integration;
    return *this;
}

Ledger& Ledger::operator+=(const Ledger& next)
{
    if (seconds == 0.0) return *this = next;
    removed += end - next.start;
    removed += next.removed;
    end = next.end;
    gravity += next.gravity;
    walls += next.walls;
    bodies += next.bodies;
    shift += next.shift;
    energy += next.energy;
    compressed = (seconds * compressed + next.seconds * next.compressed) / (seconds + next.seconds);
    seconds += next.seconds;
    return *this;
}

LedgerErrors Ledger::errors() const
{
    FluidTotals gained = end - start;
    gained += removed;
    const Wrench given = walls.total() + bodies.total();
    LedgerErrors errors;
    errors.momentum = gained.momentum + given.linear - gravity.linear;
    errors.angular_momentum = gained.angular_momentum + given.angular - gravity.angular - shift;
    errors.energy = gained.energy() + energy.walls.total() + energy.bodies.total() + energy.viscous +
                    energy.compression + energy.guard - energy.shift - energy.integration;
    errors.volume = gained.volume;
    return errors;
}

LedgerScales Ledger::scales() const
{
    const FluidTotals gained = end - start;
    LedgerScales scales;
    scales.momentum = std::max({gained.momentum.norm(), start.momentum.norm(), gravity.linear.norm(),
                                walls.total().linear.norm(), bodies.total().linear.norm()});
    scales.angular_momentum =
        std::max({gained.angular_momentum.norm(), start.angular_momentum.norm(), gravity.angular.norm(),
                  walls.total().angular.norm(), bodies.total().angular.norm(), shift.norm()});
    scales.energy =
        std::max({std::abs(gained.kinetic), std::abs(gained.potential), start.kinetic, std::abs(energy.gravity),
                  std::abs(energy.bodies.total()), std::abs(energy.viscous), std::abs(energy.compression),
                  std::abs(energy.guard), std::abs(energy.shift), std::abs(energy.integration)});
    return scales;
}

} // namespace flotsam
