#pragma once

/// Everything of flotsam that knows no rigid-body engine.
#include "flotsam/geometry/equilibrium_poses.hpp"
#include "flotsam/geometry/hydrostatics.hpp"
#include "flotsam/geometry/load_mesh.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "flotsam/world/fluid_world.hpp"
