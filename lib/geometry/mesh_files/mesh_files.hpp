#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace flotsam {

/// What is wrong with a mesh file, as the second half of a sentence ("it is truncated: ...").
class MeshFileFault : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// assimp 5.2 takes a lot on trust: a file that is not as it should be crashes it, hangs it, or passes with triangles
// missing. So each format is walked first, and assimp sees a copy with nothing in it but what makes the triangles, in
// the form that it reads best. What is wrong throws MeshFileFault.

/// Elements `vertex` (x, y, z) and `face` as binary. As it stands, a binary file whose data begins with the byte 0x0A
/// crashes assimp, and an ASCII one with a vertex on two lines aborts.
[[nodiscard]] std::string plain_ply(std::string_view file);

/// Binary files as they are; ASCII ones in lower case, without normals.
[[nodiscard]] std::string plain_stl(std::string_view file);

/// The statements v, f, o, g and usemtl, without texture coordinates and normals.
[[nodiscard]] std::string plain_obj(std::string_view file);

/// The libraries of geometries, nodes, scenes and controllers, with their numbers counted.
[[nodiscard]] std::string plain_dae(std::string_view file);

/// glTF or GLB, version 2: meshes with their positions and indices, and nodes. `path`: where buffers are looked for.
[[nodiscard]] std::string plain_gltf(std::string_view file, const std::filesystem::path& path);

} // namespace flotsam
