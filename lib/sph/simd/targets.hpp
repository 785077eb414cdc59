#pragma once

// The instruction sets that the loops over pairs are compiled for are Highway's, without those that are hardly better
// than the next one below. To be included before any of Highway's headers.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
