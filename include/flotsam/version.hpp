#pragma once

namespace flotsam {

/// The build reads its version here, so this is the one place to change it.
inline constexpr const char* kVersion = "0.1.0";

} // namespace flotsam
