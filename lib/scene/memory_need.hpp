#pragma once

#include "scene/prepared_scene.hpp"

namespace flotsam::scene {

/// Sets the estimates of particles, samples and memory; throws InputError when they are more than the machine has,
/// naming a spacing that fits.
void refuse_too_many_particles(const SceneFile& scene, PreparedScene& prepared);

} // namespace flotsam::scene
