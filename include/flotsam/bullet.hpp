#pragma once

/// flotsam with Bullet.
#include "flotsam/bullet/bullet_coupling.hpp"
#include "flotsam/flotsam.hpp"
