#pragma once

#include "flotsam/io/picture.hpp"

#include <embree3/rtcore.h>

#include <array>
#include <cstddef>
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

/// Where a ray met something, as the ray tracer says it.
struct RayHit {
    float distance;
    float u, v;  ///< place in a triangle
    Vec3 normal; ///< not of length 1
    unsigned part, primitive;
};

/// So many rays are traced together: what the ray tracer's packets hold on processors with AVX.
inline constexpr std::size_t kPacket = 8;

template <class T>
using PerRay = std::array<T, kPacket>;

/// Surfaces along a ray, near to far.
struct Passed {
    std::array<Surface, 12> surfaces;
    std::size_t count = 0; ///< those beyond the twelve nearest are left out
};

/// Things that rays meet, in one acceleration structure: first all is added, then commit, then asked by any thread,
/// about at most kPacket rays at a time. Rays that lie close together are answered fastest.
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

    /// What each ray meets first.
    [[nodiscard]] PerRay<std::optional<Surface>> closest(std::span<const Ray> rays) const;
    /// All that each ray meets; of what lies closer than `step` [m] to the one before only that.
    [[nodiscard]] PerRay<Passed> all_along(std::span<const Ray> rays, float step) const;
    /// Whether each ray meets anything.
    [[nodiscard]] PerRay<bool> blocked(std::span<const Ray> rays) const;

  private:
    struct Part {
        SurfaceKind kind;
        std::vector<Vec3> colors;  ///< per primitive, or one for all
        std::vector<Vec3> centers; ///< of spheres
        std::vector<Vec3> normals; ///< of triangles, 3 each
    };
    void attach(RTCGeometry geometry, Part part);
    [[nodiscard]] Surface surface_at(const Ray& ray, const RayHit& hit) const;
    void check() const;

    RTCDevice device_;
    RtcScene scene_;
    std::vector<Part> parts_; ///< by geometry number
};

} // namespace flotsam
