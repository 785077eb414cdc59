#pragma once

#include "scene/prepared_scene.hpp"

#include <string>
#include <utility>

namespace flotsam::scene {

/// Loads and checks the meshes that a scene names, each at its `place` in the scene; what was repaired is noted.
class MeshLoader {
  public:
    MeshLoader(const SceneFile& scene, PreparedScene& prepared) : scene_(scene), prepared_(prepared) {}

    [[nodiscard]] TriangleMesh solid(const SceneMesh& source, const std::string& place) const;
    /// The mesh and whether it is closed.
    [[nodiscard]] std::pair<TriangleMesh, bool> wall(const SceneMesh& source, const std::string& place) const;

  private:
    [[nodiscard]] std::pair<TriangleMesh, bool> load(const SceneMesh& source, const std::string& place,
                                                     bool must_be_closed, double spacing) const;

    const SceneFile& scene_;
    PreparedScene& prepared_;
};

} // namespace flotsam::scene
