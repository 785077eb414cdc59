#pragma once

#include "io/colors.hpp"
#include "io/ray_group.hpp"
#include "io/sampling.hpp"

namespace flotsam {

/// A ray from the camera.
struct Sight {
    Ray ray;
    Vec3 backdrop; ///< what is seen where nothing is, linear
    SampleSet samples;
};

/// What is behind everything; `height_in_picture` from -1 to 1. Linear.
[[nodiscard]] Vec3 backdrop_color(float height_in_picture);

/// What is seen along rays: one sun with soft shadows, a sky dimmed by near things, glass walls, a ground that melts
/// into the backdrop.
class Light {
  public:
    /// `size`: diagonal of the scene [m]. Keeps references to both groups.
    Light(const RayGroup& solid, const RayGroup& walls, const PictureScene& scene, float size);

    /// Linear colours, of at most kPacket sights.
    [[nodiscard]] PerRay<Vec3> seen_along(std::span<const Sight> sights) const;

  private:
    /// What a ray ends on, behind glass.
    struct End {
        enum class Kind { backdrop, ground, surface } kind = Kind::backdrop;
        Surface surface{};             ///< of the ground only point and normal
        Vec3 glass = Vec3::Zero();     ///< light that the glass in front sends
        float through = 1.0f;          ///< part of the light that passes it
        float sun = 0.0f, open = 0.0f; ///< parts of the sun and of the sky that light it
    };
    [[nodiscard]] PerRay<End> ends_of(std::span<const Sight> sights) const;
    [[nodiscard]] static End end_of(const Ray& ray, const std::optional<Surface>& solid, const Passed& passed);
    void shine_on(PerRay<End>& ends, std::span<const Sight> sights) const;
    [[nodiscard]] Vec3 color_of(const End& end, const Sight& sight) const;
    [[nodiscard]] Vec3 shaded(const Surface& surface, const Vec3& view, float sun, float open) const;
    [[nodiscard]] float ground_distance(const Ray& ray) const;

    const RayGroup& solid_;
    const RayGroup& walls_;
    Vec3 to_sun_;
    float offset_;        ///< of secondary rays from the surface that they start on [m]
    float ambient_reach_; ///< how near a thing must be to dim the sky [m]
    std::optional<float> ground_;
};

} // namespace flotsam
