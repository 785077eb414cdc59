#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/io/camera.hpp"
#include "flotsam/io/image.hpp"
#include "flotsam/io/placed_mesh.hpp"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace flotsam {

/// Colour of water at a fraction of the speed range, sRGB in [0, 1]: blue, cyan, white, ever lighter.
[[nodiscard]] Vec3 speed_color(double fraction);

/// Colours for bodies that are told apart from the water and from each other, sRGB in [0, 1]; repeats after eight.
[[nodiscard]] Vec3 body_color(std::size_t body);

struct PictureMesh {
    PlacedMesh placed;
    Vec3 color = Vec3(0.86f, 0.88f, 0.90f); ///< sRGB in [0, 1]
};

/// What a picture shows. Borrowed: spans and meshes must live while it is rendered.
struct PictureScene {
    int dimensions = 3;               ///< 2: meshes are cut down to as thick as the particles, about the plane y = 0
    std::span<const Vec4> particles;  ///< x, y, z [m]; w unused
    std::span<const Vec4> velocities; ///< [m/s], as many as particles; empty: all at rest
    double radius = 0.01;             ///< of the particles' spheres [m], > 0; 0.5 to 0.6 spacings look like water
    double max_speed = 0.0;           ///< drawn white [m/s]; 0: from this picture's speeds (give one for a film)
    std::vector<PictureMesh> bodies;  ///< opaque
    std::vector<PictureMesh> walls;   ///< glass where something stands behind them, else opaque; edges drawn
    std::optional<double> ground;     ///< height of a floor that takes the shadows [m]; nothing: none
    Camera camera;
    Vec3d to_sun = Vec3d(-0.45, -0.5, 1.0); ///< any length
};

/// Smallest box around all that the scene shows but the ground. (For a film whose camera stands still take the walls'.)
[[nodiscard]] Aabb bounds(const PictureScene& scene);

/// Draws pictures by ray tracing. Holds the ray tracer's device; not for use by several threads at a time.
class Renderer {
  public:
    /// Throws std::runtime_error when the ray tracer cannot run on this machine.
    Renderer();
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// The same picture for any number of workers. Particles and triangles that are not finite are left out.
    /// Throws std::invalid_argument naming the field; std::bad_alloc.
    [[nodiscard]] Image render(const PictureScene& scene, int width, int height, const Workers& workers) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotsam
