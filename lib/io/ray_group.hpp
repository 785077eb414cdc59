#pragma once

#include "flotsam/io/picture.hpp"

#include <embree3/rtcore.h>

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace flotsam {

template <auto release>
struct RtcRelease {
    template <class Handle>
    void operator()(Handle* handle) const
    {
        release(handle);
    }
};
using RtcDevice = std::unique_ptr<std::remove_pointer_t<RTCDevice>, RtcRelease<rtcReleaseDevice>>;
using RtcScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, RtcRelease<rtcReleaseScene>>;

struct Ray {
    Vec3 origin, direction; ///< direction has length 1
    float near = 0.0f, far = std::numeric_limits<float>::infinity();

    [[nodiscard]] Vec3 at(float distance) const { return origin + distance * direction; }
};

enum class SurfaceKind { water, body, wall, edge };

/// Where a ray met something.
struct Surface {
    SurfaceKind kind;
    float distance;
    Vec3 point, normal; ///< the normal looks against the ray
    Vec3 color;         ///< linear
};

/// Things that rays meet, in one acceleration structure: first all is added, then commit, then asked by any thread.
class RayGroup {
  public:
    explicit RayGroup(RTCDevice device);

    /// Colours are linear, here one per sphere.
    void add_spheres(std::span<const Vec4> centers, float radius, std::vector<Vec3> colors);
    void add_mesh(const TriangleMesh& mesh, const Vec3& color, SurfaceKind kind);
    /// Sharp and open edges as rods.
    void add_edges(const TriangleMesh& mesh, float radius, const Vec3& color);
    /// Throws std::bad_alloc, std::runtime_error.
    void commit(const Workers& workers);

    [[nodiscard]] std::optional<Surface> closest(const Ray& ray) const;
    [[nodiscard]] bool blocked(const Ray& ray) const;

  private:
    struct Part {
        SurfaceKind kind;
        std::vector<Vec3> colors;  ///< per primitive, or one for all
        std::vector<Vec3> centers; ///< of spheres
        std::vector<Vec3> normals; ///< of triangles, 3 each
    };
    void attach(RTCGeometry geometry, Part part);
    void check() const;

    RTCDevice device_;
    RtcScene scene_;
    std::vector<Part> parts_; ///< by geometry number
};

} // namespace flotsam
