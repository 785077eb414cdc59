#include "io/light.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

Vec3 backdrop_color(float height)
{
    return linear_from_srgb(mixed(Vec3(0.80f, 0.84f, 0.88f), Vec3(0.95f, 0.965f, 0.98f), 0.5f + 0.5f * height));
}

/// Part of the light that is mirrored. **Source:** Schlick 1994.
float mirrored(float cosine, float at_right_angles)
{
    return at_right_angles + (1.0f - at_right_angles) * std::pow(1.0f - std::clamp(cosine, 0.0f, 1.0f), 5.0f);
}

/// Walls that a ray passes, near to far.
struct Passed {
    std::array<Surface, 12> walls;
    std::size_t count = 0;
    std::size_t last_wall = 0; ///< 1 + index of the farthest that is no edge; 0: none
};

Passed walls_along(const RayGroup& group, Ray ray, float far, float step)
{
    Passed passed;
    ray.far = far;
    while (passed.count < passed.walls.size()) {
        const auto hit = group.closest(ray);
        if (!hit) break;
        passed.walls[passed.count++] = *hit;
        if (hit->kind == SurfaceKind::wall) passed.last_wall = passed.count;
        ray.near = hit->distance + step;
    }
    return passed;
}

} // namespace

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

Vec3 Light::seen_along(const Ray& ray, float height_in_picture, const SampleSet& samples) const
{
    const Vec3 view = -ray.direction;
    const auto solid = solid_.closest(ray);
    const float ground = ground_distance(ray);
    const float far = std::min(ground, solid ? solid->distance : ray.far);
    const Passed passed = walls_along(walls_, ray, far, 5.0f * offset_);
    const bool wall_is_backing = (!solid || solid->distance > ground) && passed.last_wall > 0;

    Vec3 color = Vec3::Zero();
    float through = 1.0f;
    const std::size_t glass = wall_is_backing ? passed.last_wall - 1 : passed.count;
    for (std::size_t k = 0; k < glass; ++k) {
        const Surface& wall = passed.walls[k];
        const bool edge = wall.kind == SurfaceKind::edge;
        const float opacity = edge ? 0.7f : 0.03f + 0.25f * mirrored(wall.normal.dot(view), 0.0f);
        color += through * opacity * (edge ? wall.color : Vec3(kGlass));
        through *= 1.0f - opacity;
    }
    const Vec3 backdrop = backdrop_color(height_in_picture);
    if (wall_is_backing) return color + through * shaded(passed.walls[passed.last_wall - 1], view, samples);
    if (solid && solid->distance <= ground) return color + through * shaded(*solid, view, samples);
    if (ground < ray.far) return color + through * ground_color(ray.at(ground), backdrop, samples);
    return color + through * backdrop;
}

Vec3 Light::shaded(const Surface& surface, const Vec3& view, const SampleSet& samples) const
{
    const Vec3& n = surface.normal;
    const float open = openness(surface.point, n, samples);
    const Vec3 sky = open * mixed(kBounce, kSky, 0.5f + 0.5f * n.z());
    Vec3 color = surface.color.cwiseProduct(sky);
    const float facing = n.dot(to_sun_);
    const float sun = facing > 0.0f ? sunlit(surface.point, n, samples) : 0.0f;
    color += surface.color.cwiseProduct(kSun) * (sun * std::max(facing, 0.0f));
    if (surface.kind == SurfaceKind::wall) return color + 0.18f * surface.color * open;

    const bool water = surface.kind == SurfaceKind::water;
    const float half = std::max(0.0f, n.dot((to_sun_ + view).normalized()));
    color += (water ? 0.35f : 0.12f) * sun * std::pow(half, water ? 60.0f : 30.0f) * kSun;
    return color + (water ? 0.30f : 0.25f) * open * mirrored(n.dot(view), 0.02f) * kSky;
}

Vec3 Light::ground_color(const Vec3& point, const Vec3& backdrop, const SampleSet& samples) const
{
    const Vec3 up = Vec3::UnitZ();
    const float sun = to_sun_.z() > 0.0f ? sunlit(point, up, samples) : 1.0f;
    return backdrop * ((0.62f + 0.38f * sun) * (0.45f + 0.55f * openness(point, up, samples)));
}

float Light::sunlit(const Vec3& point, const Vec3& normal, const SampleSet& samples) const
{
    const Vec3 direction = direction_around(to_sun_, samples.point(0), kSunSine);
    return solid_.blocked({point + offset_ * normal, direction}) ? 0.0f : 1.0f;
}

float Light::openness(const Vec3& point, const Vec3& normal, const SampleSet& samples) const
{
    float open = 0.0f;
    for (unsigned k = 0; k < SampleSet::kPoints; ++k) {
        const Vec3 direction = direction_around(normal, samples.point(k));
        if (!solid_.blocked({point + offset_ * normal, direction, 0.0f, ambient_reach_})) open += 1.0f;
    }
    return open / SampleSet::kPoints;
}

} // namespace flotsam
