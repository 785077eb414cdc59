#include "io/light.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace flotsam {

namespace {

const float kSunSine = 0.03f; // a larger sun than ours: softer shadows
const Vec3 kSun(1.15f, 1.09f, 0.98f);
const Vec3 kSky(0.50f, 0.55f, 0.62f);
const Vec3 kGlass(0.72f, 0.80f, 0.88f);
const Vec3 kBounce(0.34f, 0.33f, 0.32f);

Vec3 mixed(const Vec3& a, const Vec3& b, float t)
{
    return (1.0f - t) * a + t * b;
}

/// x to a whole power.
template <unsigned power>
float to_the(float x)
{
    if constexpr (power == 1)
        return x;
    else
        return to_the<power / 2>(x * x) * (power % 2 == 1 ? x : 1.0f);
}

/// Part of the light that is mirrored. **Source:** Schlick 1994.
float mirrored(float cosine, float at_right_angles)
{
    return at_right_angles + (1.0f - at_right_angles) * to_the<5>(1.0f - std::clamp(cosine, 0.0f, 1.0f));
}

/// Rays of some of a packet's sights, so that none is traced for nothing.
class SomeRays {
  public:
    void add(std::size_t sight, const Ray& ray)
    {
        sights_[count_] = sight;
        rays_[count_++] = ray;
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::size_t sight(std::size_t k) const { return sights_[k]; }
    [[nodiscard]] std::span<const Ray> rays() const { return {rays_.data(), count_}; }

  private:
    PerRay<Ray> rays_;
    PerRay<std::size_t> sights_;
    std::size_t count_ = 0;
};

} // namespace

Vec3 backdrop_color(float height)
{
    return linear_from_srgb(mixed(Vec3(0.80f, 0.84f, 0.88f), Vec3(0.95f, 0.965f, 0.98f), 0.5f + 0.5f * height));
}

Light::Light(const RayGroup& solid, const RayGroup& walls, const PictureScene& scene, float size)
    : solid_(solid), walls_(walls), to_sun_(scene.to_sun.normalized().cast<Scalar>()), offset_(5e-5f * size),
      ambient_reach_(0.12f * size)
{
    if (scene.ground) ground_ = static_cast<float>(*scene.ground) - 10.0f * offset_;
}

float Light::ground_distance(const Ray& ray) const
{
    if (!ground_ || ray.direction.z() > -1e-4f) return ray.far;
    const float distance = (*ground_ - ray.origin.z()) / ray.direction.z();
    return distance > 0.0f ? distance : ray.far;
}

PerRay<Vec3> Light::seen_along(std::span<const Sight> sights) const
{
    PerRay<End> ends = ends_of(sights);
    shine_on(ends, sights);
    PerRay<Vec3> colors;
    for (std::size_t k = 0; k < sights.size(); ++k) colors[k] = color_of(ends[k], sights[k]);
    return colors;
}

PerRay<Light::End> Light::ends_of(std::span<const Sight> sights) const
{
    PerRay<Ray> rays;
    for (std::size_t k = 0; k < sights.size(); ++k) {
        rays[k] = sights[k].ray;
        rays[k].far = ground_distance(rays[k]);
    }
    const std::span<const Ray> all(rays.data(), sights.size());
    const auto solids = solid_.closest(all);
    for (std::size_t k = 0; k < sights.size(); ++k)
        if (solids[k]) rays[k].far = solids[k]->distance;
    const auto passed = walls_.all_along(all, 5.0f * offset_);

    PerRay<End> ends;
    for (std::size_t k = 0; k < sights.size(); ++k) ends[k] = end_of(rays[k], solids[k], passed[k]);
    return ends;
}

Light::End Light::end_of(const Ray& ray, const std::optional<Surface>& solid, const Passed& passed)
{
    std::size_t to_last_wall = passed.count;
    while (to_last_wall > 0 && passed.surfaces[to_last_wall - 1].kind != SurfaceKind::wall) --to_last_wall;

    End end;
    std::size_t glass = passed.count;
    if (solid) {
        end.kind = End::Kind::surface;
        end.surface = *solid;
    } else if (to_last_wall > 0) { // with nothing behind it a wall is opaque
        glass = to_last_wall - 1;
        end.kind = End::Kind::surface;
        end.surface = passed.surfaces[glass];
    } else if (ray.far < std::numeric_limits<float>::infinity()) {
        end.kind = End::Kind::ground;
        end.surface.point = ray.at(ray.far);
        end.surface.normal = Vec3::UnitZ();
    }
    for (std::size_t k = 0; k < glass; ++k) {
        const Surface& wall = passed.surfaces[k];
        const bool edge = wall.kind == SurfaceKind::edge;
        const float opacity = edge ? 0.7f : 0.03f + 0.25f * mirrored(-wall.normal.dot(ray.direction), 0.0f);
        end.glass += end.through * opacity * (edge ? wall.color : kGlass);
        end.through *= 1.0f - opacity;
    }
    return end;
}

void Light::shine_on(PerRay<End>& ends, std::span<const Sight> sights) const
{
    SomeRays to_sun;
    std::array<SomeRays, SampleSet::kPoints> to_sky;
    for (std::size_t k = 0; k < sights.size(); ++k) {
        if (ends[k].kind == End::Kind::backdrop) continue;
        const Vec3& normal = ends[k].surface.normal;
        const Vec3 start = ends[k].surface.point + offset_ * normal;
        const SampleSet& samples = sights[k].samples;
        if (normal.dot(to_sun_) > 0.0f) to_sun.add(k, {start, direction_around(to_sun_, samples.point(0), kSunSine)});
        for (unsigned p = 0; p < SampleSet::kPoints; ++p)
            to_sky[p].add(k, {start, direction_around(normal, samples.point(p)), 0.0f, ambient_reach_});
    }
    const auto in_shadow = solid_.blocked(to_sun.rays());
    for (std::size_t r = 0; r < to_sun.count(); ++r) ends[to_sun.sight(r)].sun = in_shadow[r] ? 0.0f : 1.0f;
    for (const SomeRays& rays : to_sky) {
        const auto dimmed = solid_.blocked(rays.rays());
        for (std::size_t r = 0; r < rays.count(); ++r)
            if (!dimmed[r]) ends[rays.sight(r)].open += 1.0f / SampleSet::kPoints;
    }
}

Vec3 Light::color_of(const End& end, const Sight& sight) const
{
    Vec3 color = sight.backdrop;
    if (end.kind == End::Kind::surface) {
        color = shaded(end.surface, -sight.ray.direction, end.sun, end.open);
    } else if (end.kind == End::Kind::ground) {
        const float sun = to_sun_.z() > 0.0f ? end.sun : 1.0f;
        color *= (0.62f + 0.38f * sun) * (0.45f + 0.55f * end.open);
    }
    return end.glass + end.through * color;
}

Vec3 Light::shaded(const Surface& surface, const Vec3& view, float sun, float open) const
{
    const Vec3& n = surface.normal;
    const Vec3 sky = open * mixed(kBounce, kSky, 0.5f + 0.5f * n.z());
    Vec3 color = surface.color.cwiseProduct(sky);
    color += surface.color.cwiseProduct(kSun) * (sun * std::max(n.dot(to_sun_), 0.0f));
    if (surface.kind == SurfaceKind::wall) return color + 0.18f * surface.color * open;

    const bool water = surface.kind == SurfaceKind::water;
    const float half = std::max(0.0f, n.dot((to_sun_ + view).normalized()));
    color += (water ? 0.35f : 0.12f) * sun * (water ? to_the<60>(half) : to_the<30>(half)) * kSun;
    return color + (water ? 0.30f : 0.25f) * open * mirrored(n.dot(view), 0.02f) * kSky;
}

} // namespace flotsam
