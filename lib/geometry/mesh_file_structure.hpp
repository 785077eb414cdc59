#pragma once

#include <string>
#include <string_view>

namespace flotsam {

/// What assimp takes on trust or trips over, in one sentence part ("it is truncated: ..."); empty if nothing is wrong.
/// A PLY file that ends early crashes assimp 5.2 or hangs it, and so do indices of vertices that are not there; a cut
/// ASCII STL passes as a smaller mesh.
[[nodiscard]] std::string fault_of_ply(std::string_view file);
[[nodiscard]] std::string fault_of_stl(std::string_view file);

} // namespace flotsam
