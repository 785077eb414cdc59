#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/io/csv.hpp"
#include "flotsam/io/output_directory.hpp"
#include "flotsam/io/picture.hpp"
#include "flotsam/io/vtk.hpp"
#include "scene/frame_writer.hpp"
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

/// Frames for ParaView: particles.pvd, bodies.pvd and what they name in vtk/, with the walls in vtk/walls.vtp. The
/// frames are written in the background, from copies; `prepared` must not change meanwhile.
class VtkFrames {
  public:
    VtkFrames(const std::filesystem::path& directory, const PreparedScene& prepared, const SceneWorld& world);
    void add(const SceneWorld& world);
    void wait() { writer_.wait(); }
    void check() { writer_.check(); } ///< throws what went wrong with a frame

  private:
    void write(double time, const FluidState& fluid, const std::vector<Pose>& poses);

    std::filesystem::path directory_;
    const PreparedScene& prepared_;
    PvdSeries particles_, bodies_;
    FrameWriter writer_; ///< last: it uses all of the above
};

/// pictures/frame_0000.png and so on, drawn in the background from copies of what they show.
class Pictures {
  public:
    Pictures(const std::filesystem::path& directory, const SceneFile& scene, const PreparedScene& prepared,
             const SceneWorld& world, int threads);
    /// Draws the frame if it is one of those to be drawn.
    void add(int frame, bool last, const SceneWorld& world);
    void wait() { writer_.wait(); }
    void check() { writer_.check(); } ///< throws what went wrong with a frame

  private:
    void write(int frame, const std::vector<Vec4>& positions, const std::vector<Vec4>& velocities,
               const std::vector<Pose>& poses);

    std::filesystem::path directory_;
    int width_, height_; ///< [pixels]
    Renderer renderer_;
    Workers workers_;
    std::vector<TriangleMesh> walls_, bodies_; ///< in 2-D as thin as a spacing
    PictureScene picture_;
    int every_ = 1;
    FrameWriter writer_; ///< last: it uses all of the above
};

} // namespace flotsam::scene
