#pragma once

#include "flotsam/io/placed_mesh.hpp"
#include "flotsam/validation/validation.hpp"
#include "flotsam/world/fluid_world.hpp"

#include <span>
#include <string>

namespace flotsam::validation {

constexpr int kPictureWidth = 480, kPictureHeight = 270; ///< [pixels]: a few of them leave the page small

/// The water, its walls and `bodies` as they are now.
[[nodiscard]] ValidationPicture take_picture(const std::string& caption, const FluidWorld& water,
                                             std::span<const PlacedMesh> bodies, const ValidationOptions& options);

} // namespace flotsam::validation
