#pragma once

#include "io/colors.hpp"
#include "io/ray_group.hpp"
#include "io/sampling.hpp"

namespace flotsam {

/// What is seen along rays: one sun with soft shadows, a sky dimmed by near things, glass walls, a ground that melts
/// into the backdrop.
class Light {
  public:
    /// `size`: diagonal of the scene [m]. Keeps references to both groups.
    Light(const RayGroup& solid, const RayGroup& walls, const PictureScene& scene, float size);

    /// Linear colour; `height_in_picture` from -1 to 1.
    [[nodiscard]] Vec3 seen_along(const Ray& ray, float height_in_picture, const SampleSet& samples) const;

  private:
    [[nodiscard]] Vec3 shaded(const Surface& surface, const Vec3& view, const SampleSet& samples) const;
    [[nodiscard]] Vec3 ground_color(const Vec3& point, const Vec3& backdrop, const SampleSet& samples) const;
    [[nodiscard]] float sunlit(const Vec3& point, const Vec3& normal, const SampleSet& samples) const;
    [[nodiscard]] float openness(const Vec3& point, const Vec3& normal, const SampleSet& samples) const;
    [[nodiscard]] float ground_distance(const Ray& ray) const;

    const RayGroup& solid_;
    const RayGroup& walls_;
    Vec3 to_sun_;
    float offset_;        ///< of secondary rays from the surface that they start on [m]
    float ambient_reach_; ///< how near a thing must be to dim the sky [m]
    std::optional<float> ground_;
};

} // namespace flotsam
