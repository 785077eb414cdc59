#include "validation/take_picture.hpp"

#include "flotsam/io/picture.hpp"

#include <cmath>

namespace flotsam::validation {

ValidationPicture take_picture(const std::string& caption, const FluidWorld& water, std::span<const PlacedMesh> bodies,
                               const ValidationOptions& options)
{
    const FluidWorldSettings& settings = water.settings();
    PictureScene scene;
    scene.dimensions = settings.dimensions;
    scene.particles = water.fluid().position;
    scene.velocities = water.fluid().velocity;
    scene.radius = 0.55 * settings.particle_spacing;
    const double height = bounds(scene).size().z();
    scene.max_speed = std::sqrt(2.0 * settings.gravity.norm() * height); // so that still water is not white
    for (std::size_t k = 0; k < bodies.size(); ++k) scene.bodies.push_back({bodies[k], body_color(k)});
    for (int k = 0; k < water.wall_count(); ++k) scene.walls.push_back({.placed = {&water.wall_mesh(k), Pose()}});
    scene.camera = default_camera(bounds(scene), static_cast<double>(kPictureWidth) / kPictureHeight, scene.dimensions);
    if (scene.dimensions == 3) scene.ground = bounds(scene).min.z();
    return {caption, png_of(Renderer().render(scene, kPictureWidth, kPictureHeight, Workers(options.threads)))};
}

} // namespace flotsam::validation
