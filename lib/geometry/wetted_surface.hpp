#pragma once

#include "flotsam/geometry/hydrostatics.hpp"

#include <array>
#include <optional>
#include <vector>

namespace flotsam {

/// A mesh in water, to be asked about many levels of it.
class WettedSurface {
  public:
    WettedSurface(const TriangleMesh& closed, const Pose& pose);

    [[nodiscard]] double low() const { return low_; } ///< lowest vertex in the world [m]
    /// As flotsam::basins.
    [[nodiscard]] std::vector<char> basins(double water_level) const;
    [[nodiscard]] bool has_basin(double water_level) const;
    /// What the mesh displaces, its basins included [m^3].
    [[nodiscard]] double displacement(double water_level) const;
    /// The water level at which she displaces `volume` [m^3], as vessel_draft has it; nothing if she sinks or founders.
    [[nodiscard]] std::optional<double> level_of_displacement(double water_level, double volume) const;
    /// The water level, or the highest of some above it, at which there are basins. Nothing for what has none there:
    /// a solid, or a vessel that is flooded.
    [[nodiscard]] std::optional<double> level_of_basins(double water_level) const;

  private:
    /// The parts of the surface below the water that hang together there.
    struct Parts {
        std::vector<std::size_t> part; ///< of each triangle; kDry: it is above the water
        std::vector<double> volume;    ///< that each bounds with the water plane [m^3]; < 0: outside of the solid
    };
    [[nodiscard]] Parts parts(double water_level) const;

    std::vector<Vec3d> vertices_; ///< in the world, those at one place as one
    std::vector<std::array<int, 3>> triangles_;
    double low_, high_;
};

} // namespace flotsam
