#pragma once

#include "flotsam/io/placed_mesh.hpp"
#include "flotsam/sph/boundary_state.hpp"
#include "flotsam/sph/fluid_state.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace flotsam {

// Frames for ParaView: VTK XML PolyData (.vtp) with raw appended data, and the .pvd that strings them along time.
// **Source:** Kitware, VTK File Formats, "XML file formats". All lengths in metres, world frame. All throw OutputError.

/// Particles as vertices in memory order, with velocity [m/s], speed [m/s], density [kg/m^3], pressure [Pa] and id. The
/// pressure is the solver's: half as much again in the layer at a solid, which bears all of its force
/// (FluidWorld::pressure_at is without that).
void write_particles_vtp(const std::filesystem::path& file, const FluidState& fluid);

/// All bodies in one file; cell data `body` is the index into `bodies`.
void write_bodies_vtp(const std::filesystem::path& file, std::span<const PlacedMesh> bodies);

/// Boundary samples as vertices, with velocity [m/s], rest volume [m^3] and owner (0: walls, 1 + k: body k).
void write_boundary_vtp(const std::filesystem::path& file, const BoundaryState& boundary);

/// A .pvd collection: frames and their times. The file on disk is whole after every frame, so ParaView can follow a run
/// that is still going on.
class PvdSeries {
  public:
    explicit PvdSeries(std::filesystem::path file) : file_(std::move(file)) {}

    /// Adds a frame and rewrites the collection. `frame` counts from the .pvd's directory unless it is absolute, `time`
    /// in seconds, finite. Throws OutputError, std::invalid_argument.
    void add(double time, const std::filesystem::path& frame);

    [[nodiscard]] std::size_t size() const { return entries_.size(); }

  private:
    std::filesystem::path file_;
    std::vector<std::string> entries_;
};

} // namespace flotsam
