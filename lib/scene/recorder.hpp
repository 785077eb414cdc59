#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/io/csv.hpp"
#include "flotsam/io/output_directory.hpp"
#include "flotsam/io/picture.hpp"
#include "flotsam/io/vtk.hpp"
#include "scene/run_tally.hpp"
#include "scene/scene_world.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace flotsam::scene {

/// history.csv: a row per frame, forces as means over the frame.
class History {
  public:
    History(const std::filesystem::path& file, const SceneFile& scene);

    void add_step(const SceneWorld& world, double dt);
    void write_row(const SceneFile& scene, const PreparedScene& prepared, const SceneWorld& world);
    void close() { writer_.close(); }

  private:
    CsvWriter writer_;
    std::vector<Wrench> impulses_; ///< of this frame, per body
    double seconds_ = 0.0;         ///< of this frame
};

/// Frames for ParaView: particles.pvd, bodies.pvd and what they name in vtk/, with the walls in vtk/walls.vtp.
class VtkFrames {
  public:
    VtkFrames(const std::filesystem::path& directory, const SceneWorld& world);
    void write(const PreparedScene& prepared, const SceneWorld& world);

  private:
    std::filesystem::path directory_;
    PvdSeries particles_, bodies_;
};

/// pictures/frame_0000.png and so on.
class Pictures {
  public:
    Pictures(const std::filesystem::path& directory, const SceneFile& scene, const PreparedScene& prepared,
             const SceneWorld& world, int threads);
    /// Draws the frame if it is one of those to be drawn.
    void write(int frame, bool last, const SceneFile& scene, const SceneWorld& world);

  private:
    std::filesystem::path directory_;
    Renderer renderer_;
    Workers workers_;
    std::vector<TriangleMesh> walls_, bodies_; ///< in 2-D as thin as a spacing
    PictureScene picture_;
    int every_ = 1;
};

} // namespace flotsam::scene
