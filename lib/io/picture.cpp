#include "flotsam/io/picture.hpp"

#include "flotsam/core/contracts.hpp"
#include "io/colors.hpp"
#include "io/light.hpp"
#include "io/ray_group.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace flotsam {

namespace {

void require_valid(const PictureScene& scene)
{
    require(scene.radius > 0.0 && std::isfinite(scene.radius), "the radius of the particles must be > 0 [m]",
            scene.radius);
    require(scene.dimensions == 2 || scene.dimensions == 3, "dimensions must be 2 or 3", scene.dimensions);
    require(scene.max_speed >= 0.0, "the speed drawn white must be > 0 [m/s], or 0 for automatic", scene.max_speed);
    require(scene.velocities.empty() || scene.velocities.size() == scene.particles.size(),
            "there must be as many velocities as particles, or none", scene.velocities.size());
    for (const auto* meshes : {&scene.bodies, &scene.walls}) {
        for (const PictureMesh& mesh : *meshes) require(mesh.placed.mesh != nullptr, "every mesh must be given");
    }
    const Camera& camera = scene.camera;
    const Vec3d view = camera.look_at - camera.position;
    require(view.norm() > 0.0 && view.allFinite(), "the camera must look at a point elsewhere than its position");
    require(view.cross(camera.up).norm() > 1e-6 * view.norm() * camera.up.norm() && camera.up.allFinite(),
            "the camera's up must not lie along its view");
    require(camera.field_of_view_deg > 0.0 && camera.field_of_view_deg <= 170.0,
            "the camera's field of view must be above 0 and at most 170 degrees", camera.field_of_view_deg);
    require(scene.to_sun.norm() > 0.0 && scene.to_sun.allFinite(), "the sun must have a direction");
}

Aabb bounds_of_particles(const PictureScene& scene)
{
    Aabb box;
    for (const Vec4& p : scene.particles) {
        if (p.head<3>().allFinite()) box.extend(p.head<3>().cast<double>());
    }
    return box.empty() ? box : box.inflated(scene.radius);
}

/// Most speeds lie below it, and slow creeping in a still tank stays dark: at least the speed of a fall through a
/// twentieth of the water's height.
double automatic_max_speed(std::vector<float> speeds, const PictureScene& scene)
{
    if (speeds.empty()) return 1.0;
    const auto nearly_fastest =
        speeds.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(speeds.size() - 1));
    std::nth_element(speeds.begin(), nearly_fastest, speeds.end());
    const Aabb water = bounds_of_particles(scene);
    const double height = water.empty() ? 1.0 : water.size().z();
    return std::max(static_cast<double>(*nearly_fastest), std::sqrt(2.0 * 9.81 * 0.05 * height));
}

std::vector<Vec3> water_colors(const PictureScene& scene, const std::vector<float>& speeds)
{
    const double max_speed = scene.max_speed > 0.0 ? scene.max_speed : automatic_max_speed(speeds, scene);
    std::vector<Vec3> colors;
    colors.reserve(speeds.size());
    for (const float speed : speeds) colors.push_back(linear_from_srgb(speed_color(speed / max_speed)));
    return colors;
}

std::vector<float> speeds_of(const PictureScene& scene)
{
    std::vector<float> speeds(scene.particles.size(), 0.0f);
    for (std::size_t i = 0; i < scene.velocities.size(); ++i) {
        const float speed = scene.velocities[i].head<3>().norm();
        speeds[i] = std::isfinite(speed) ? speed : 0.0f;
    }
    return speeds;
}

/// Turns places in the picture, (-1, -1) lower left to (1, 1) upper right, into rays.
class Lens {
  public:
    /// Rays start `ahead` of the camera [m].
    Lens(const Camera& camera, double aspect, double ahead)
        : origin_(camera.position.cast<Scalar>()), ahead_(static_cast<Scalar>(ahead)),
          forward_((camera.look_at - camera.position).normalized().cast<Scalar>())
    {
        const double half = std::tan(0.5 * camera.field_of_view_deg * std::numbers::pi / 180.0);
        const Vec3 right = forward_.cross(camera.up.cast<Scalar>()).normalized();
        half_up_ = static_cast<Scalar>(half) * right.cross(forward_);
        half_right_ = static_cast<Scalar>(half * aspect) * right;
    }
    [[nodiscard]] Ray ray(float x, float y) const
    {
        const Vec3 direction = (forward_ + x * half_right_ + y * half_up_).normalized();
        return {origin_ + ahead_ * direction, direction};
    }

  private:
    Vec3 origin_;
    Scalar ahead_;
    Vec3 forward_, half_right_, half_up_;
};

/// Draws pixels, several at a time.
class Eye {
  public:
    static constexpr std::size_t kPixels = kPacket / kSamplesPerPixel; ///< at a time

    Eye(const Light& light, const Lens& lens, int width, int height)
        : light_(light), lens_(lens), width_(width), height_(height)
    {
        for (int row = 0; row < height; ++row)
            for (unsigned k = 0; k < kSamplesPerPixel; ++k) backdrops_.push_back(backdrop_color(y_in_picture(row, k)));
    }
    /// Those from number `first` up to `end`, row by row; at most kPixels.
    void draw(std::size_t first, std::size_t end, Image& image) const
    {
        PerRay<Sight> sights;
        std::array<float, kPixels> dither;
        for (std::size_t index = first; index < end; ++index) {
            const auto column = static_cast<int>(index % static_cast<std::size_t>(width_));
            const auto row = static_cast<int>(index / static_cast<std::size_t>(width_));
            const PixelPattern pattern = pixel_pattern(column, row);
            dither[index - first] = pattern.first;
            for (unsigned k = 0; k < kSamplesPerPixel; ++k)
                sights[(index - first) * kSamplesPerPixel + k] = sight(column, row, pattern, k);
        }
        const auto seen = light_.seen_along({sights.data(), (end - first) * kSamplesPerPixel});
        for (std::size_t index = first; index < end; ++index) {
            Vec3 sum = Vec3::Zero();
            for (unsigned k = 0; k < kSamplesPerPixel; ++k) sum += seen[(index - first) * kSamplesPerPixel + k];
            store_srgb(sum / kSamplesPerPixel, dither[index - first], image.pixel(index));
        }
    }

  private:
    [[nodiscard]] float y_in_picture(int row, unsigned sample) const
    {
        return 1.0f - 2.0f * (static_cast<float>(row) + place_in_pixel(sample).second) / static_cast<float>(height_);
    }
    [[nodiscard]] Sight sight(int column, int row, const PixelPattern& pattern, unsigned k) const
    {
        const float x =
            2.0f * (static_cast<float>(column) + place_in_pixel(k).first) / static_cast<float>(width_) - 1.0f;
        return {lens_.ray(x, y_in_picture(row, k)), backdrops_[static_cast<std::size_t>(row) * kSamplesPerPixel + k],
                SampleSet(pattern, k)};
    }

    const Light& light_;
    const Lens& lens_;
    int width_, height_;
    std::vector<Vec3> backdrops_; ///< of each row's samples
};

/// World mesh as it is drawn. Walls are the thicker ones in 2-D, or body and glass would lie in one plane.
TriangleMesh drawn(const PlacedMesh& placed, const PictureScene& scene, SurfaceKind kind)
{
    const double half_thickness = (kind == SurfaceKind::wall ? 1.1 : 1.0) * scene.radius;
    TriangleMesh mesh = transformed(*placed.mesh, placed.pose);
    if (scene.dimensions == 2) {
        for (Vec3d& vertex : mesh.vertices) vertex.y() = std::clamp(vertex.y(), -half_thickness, half_thickness);
    }
    return mesh;
}

} // namespace

Aabb bounds(const PictureScene& scene)
{
    Aabb box = bounds_of_particles(scene);
    for (const auto* meshes : {&scene.bodies, &scene.walls}) {
        for (const PictureMesh& mesh : *meshes) {
            for (const Vec3d& vertex : drawn(mesh.placed, scene, SurfaceKind::wall).vertices) box.extend(vertex);
        }
    }
    return box;
}

struct Renderer::Impl {
    RtcDevice device;
};

Renderer::Renderer() : impl_(std::make_unique<Impl>())
{
    impl_->device.reset(rtcNewDevice("start_threads=0,set_affinity=0"));
    if (impl_->device == nullptr) throw std::runtime_error("the ray tracer (Embree) cannot run on this machine");
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Image Renderer::render(const PictureScene& scene, int width, int height, const Workers& workers) const
{
    require_valid(scene);
    Image image(width, height);
    const Aabb box = bounds(scene);
    const auto size = static_cast<float>(box.empty() ? 1.0 : box.size().norm());

    RayGroup solid(impl_->device.get());
    solid.add_spheres(scene.particles, static_cast<float>(scene.radius), water_colors(scene, speeds_of(scene)));
    for (const PictureMesh& body : scene.bodies) {
        solid.add_mesh(drawn(body.placed, scene, SurfaceKind::body), linear_from_srgb(body.color), SurfaceKind::body);
    }
    solid.commit(workers);
    RayGroup walls(impl_->device.get());
    for (const PictureMesh& wall : scene.walls) {
        const TriangleMesh mesh = drawn(wall.placed, scene, SurfaceKind::wall);
        walls.add_mesh(mesh, linear_from_srgb(wall.color), SurfaceKind::wall);
        walls.add_edges(mesh, 0.0008f * size, linear_from_srgb(Vec3(0.55f, 0.60f, 0.66f)));
    }
    walls.commit(workers);

    const Light light(solid, walls, scene, size);
    // A ray that starts far away loses the digits that its secondary rays need.
    const double ahead = box.empty() ? 0.0 : std::max(0.0, (scene.camera.position - box.center()).norm() - 0.6 * size);
    const Lens lens(scene.camera, static_cast<double>(width) / height, ahead);
    const Eye eye(light, lens, width, height);
    workers.for_chunks(image.rgb.size() / 3, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t first = begin; first < end; first += Eye::kPixels)
            eye.draw(first, std::min(first + Eye::kPixels, end), image);
    });
    return image;
}

} // namespace flotsam
