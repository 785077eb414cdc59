#include "support/catch.hpp"

#include "flotsam/io/output_error.hpp"
#include "flotsam/io/picture.hpp"
#include "unit/io/scratch.hpp"

#include <png.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

using namespace flotsam;

namespace {

TriangleMesh open_box(const Vec3d& min, const Vec3d& max)
{
    TriangleMesh mesh;
    for (int k = 0; k < 8; ++k) {
        mesh.vertices.emplace_back((k & 1) ? max.x() : min.x(), (k & 2) ? max.y() : min.y(),
                                   (k & 4) ? max.z() : min.z());
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7},
                      {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// A camera far off on the -y side, so that the picture is the plane y = 0 from -1 to 1, and z up.
Camera straight()
{
    Camera camera;
    camera.position = Vec3d(0, -100, 0);
    camera.field_of_view_deg = 2.0 * std::atan(0.01) * 180.0 / std::numbers::pi;
    return camera;
}

Vec3 color_at(const Image& image, int column, int row)
{
    const std::uint8_t* p = image.pixel(static_cast<std::size_t>(row * image.width + column));
    return Vec3(p[0], p[1], p[2]) / 255.0f;
}

bool bluish(const Vec3& color)
{
    return color.z() > 1.5f * color.x();
}

} // namespace

TEST_CASE("a sphere is drawn where it is, as large as it is", "[io][picture]")
{
    const std::vector<Vec4> particles = {Vec4(0.5f, 0.0f, 0.5f, 0.0f)};
    PictureScene scene;
    scene.particles = particles;
    scene.radius = 0.3;
    scene.camera = straight();
    const Image image = Renderer().render(scene, 100, 100, Workers(1));
    int blue = 0;
    for (int row = 0; row < 100; ++row) {
        for (int column = 0; column < 100; ++column) blue += bluish(color_at(image, column, row)) ? 1 : 0;
    }
    CHECK(bluish(color_at(image, 75, 25)));
    CHECK_FALSE(bluish(color_at(image, 25, 25)));
    CHECK_FALSE(bluish(color_at(image, 75, 75)));
    CHECK(blue == Approx(std::numbers::pi * 15 * 15).epsilon(0.1)); // highlight and rim are not blue
}

TEST_CASE("faster water is lighter", "[io][picture]")
{
    const std::vector<Vec4> particles = {Vec4(-0.5f, 0, 0, 0), Vec4(0.5f, 0, 0, 0)};
    const std::vector<Vec4> velocities = {Vec4(0.1f, 0, 0, 0), Vec4(0, 0, -2.0f, 0)};
    PictureScene scene;
    scene.particles = particles;
    scene.velocities = velocities;
    scene.radius = 0.3;
    scene.camera = straight();
    scene.max_speed = 2.0;
    const Renderer renderer;
    const Image image = renderer.render(scene, 40, 40, Workers(1));
    CHECK(color_at(image, 30, 20).sum() > color_at(image, 10, 20).sum() + 0.5f);
    scene.max_speed = 200.0;
    const Image slow = renderer.render(scene, 40, 40, Workers(1));
    CHECK(color_at(slow, 30, 20).sum() < color_at(image, 30, 20).sum() - 0.5f);
    for (double fraction = 0.0; fraction < 1.0; fraction += 0.05) { // lightness tells the speed
        CHECK(speed_color(fraction + 0.05).sum() > speed_color(fraction).sum());
    }
    CHECK(speed_color(std::numeric_limits<double>::quiet_NaN()) == speed_color(0.0));
}

TEST_CASE("one sees through the near walls of a tank and not through the far ones", "[io][picture]")
{
    const TriangleMesh tank = open_box({-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9});
    const std::vector<Vec4> particles = {Vec4(0, 0, 0, 0)};
    PictureScene scene;
    scene.particles = particles;
    scene.radius = 0.3;
    scene.camera = straight();
    const Renderer renderer;
    const Image bare = renderer.render(scene, 40, 40, Workers(1));
    scene.walls = {{{&tank, {}}, Vec3(1.0f, 0.2f, 0.2f)}};
    const Image image = renderer.render(scene, 40, 40, Workers(1));
    CHECK((color_at(image, 20, 20) - color_at(bare, 20, 20)).norm() < 0.15f); // the water, through glass
    const Vec3 behind = color_at(image, 8, 8);                                // the far wall
    CHECK(behind.x() > 1.5f * behind.y());
}

TEST_CASE("bodies have their colour and pose and throw shadows", "[io][picture]")
{
    const TriangleMesh cube = open_box(Vec3d::Constant(-0.2), Vec3d::Constant(0.2));
    PictureScene scene;
    scene.bodies = {{{&cube, {{0.5, 0, 0.5}, Quatd::Identity()}}, Vec3(0.9f, 0.1f, 0.1f)}};
    scene.camera = straight();
    scene.camera.position.z() = 40; // sees the ground
    const Renderer renderer;
    const Image floating = renderer.render(scene, 60, 60, Workers(1));
    const Vec3 body = color_at(floating, 44, 15);
    CHECK(body.x() > 2.0f * body.y());
    scene.ground = 0.0;
    const Image grounded = renderer.render(scene, 60, 60, Workers(1));
    float darkest = 1.0f;
    for (int row = 0; row < 60; ++row) {
        for (int column = 0; column < 60; ++column) {
            darkest = std::min(darkest, color_at(grounded, column, row).y() / color_at(floating, column, row).y());
        }
    }
    CHECK(darkest < 0.9f);
}

TEST_CASE("in 2-D meshes are as thin as the particles", "[io][picture]")
{
    const TriangleMesh bar = open_box({-0.2, -0.5, -0.2}, {0.2, 0.5, 0.2});
    PictureScene scene;
    scene.radius = 0.05;
    scene.bodies = {{{&bar, {}}}};
    CHECK(bounds(scene).size().y() == Approx(1.0));
    scene.dimensions = 2;
    CHECK(bounds(scene).size().y() < 0.12);
}

TEST_CASE("a picture is the same for any number of workers", "[io][picture]")
{
    const TriangleMesh tank = open_box(Vec3d::Constant(-1), Vec3d::Constant(1));
    std::vector<Vec4> particles;
    for (int k = 0; k < 2000; ++k) {
        const auto x = static_cast<float>(k);
        particles.emplace_back(std::sin(x), std::sin(1.7f * x), std::sin(2.9f * x), 0.0f);
    }
    PictureScene scene;
    scene.particles = scene.velocities = particles;
    scene.radius = 0.05;
    scene.walls = {{{&tank, {}}}};
    scene.ground = -1.0;
    scene.camera = default_camera(bounds(scene), 1.5);
    const Renderer renderer;
    const Image one = renderer.render(scene, 90, 60, Workers(1));
    CHECK(renderer.render(scene, 90, 60, Workers(2)).rgb == one.rgb);
    CHECK(renderer.render(scene, 90, 60, Workers(3)).rgb == one.rgb);
}

TEST_CASE("an empty scene is a backdrop", "[io][picture]")
{
    CHECK(Renderer().render({}, 8, 8, Workers(1)).rgb[0] > 128);
}

TEST_CASE("a renderer leaves the application's threads alone", "[io][picture]")
{
    if (std::thread::hardware_concurrency() < 2) return;
    const Renderer renderer;
    (void)renderer.render({}, 8, 8, Workers(1));
    // Two chunks that wait for each other: both are there at once only if two threads work.
    std::atomic<int> arrived{0};
    std::atomic<int> met{0};
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    Workers(2).for_chunks(2 * Workers::kChunk, [&](std::size_t, std::size_t, std::size_t) {
        ++arrived;
        while (arrived < 2 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
        if (arrived == 2) ++met;
    });
    CHECK(met == 2);
}

TEST_CASE("particles that are not numbers are left out", "[io][picture]")
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<Vec4> particles = {Vec4(0, 0, 0, 0), Vec4(nan, 0, 0, 0), Vec4(0, inf, 0, 0)};
    const std::vector<Vec4> velocities = {Vec4(1, 0, 0, 0), Vec4(nan, 0, 0, 0), Vec4(inf, 0, 0, 0)};
    PictureScene scene;
    scene.radius = 0.3;
    scene.max_speed = 1.0;
    scene.camera = straight();
    scene.particles = particles;
    scene.velocities = velocities;
    const Renderer renderer;
    const Image image = renderer.render(scene, 40, 40, Workers(1));
    scene.particles = scene.particles.first(1);
    scene.velocities = scene.velocities.first(1);
    CHECK(image.rgb == renderer.render(scene, 40, 40, Workers(1)).rgb);
    CHECK(bounds(scene).max.x() == Approx(0.3));
}

TEST_CASE("a renderer refuses scenes it cannot draw", "[io][picture]")
{
    const Renderer renderer;
    const std::vector<Vec4> one(1, Vec4::Zero());
    PictureScene scene;
    scene.particles = one;
    const auto refused = [&](auto&& change) {
        PictureScene bad = scene;
        change(bad);
        CHECK_THROWS_AS(renderer.render(bad, 8, 8, Workers(1)), std::invalid_argument);
    };
    refused([](PictureScene& s) { s.radius = 0.0; });
    refused([](PictureScene& s) { s.radius = std::numeric_limits<double>::quiet_NaN(); });
    refused([](PictureScene& s) { s.max_speed = -1.0; });
    refused([](PictureScene& s) { s.dimensions = 1; });
    refused([](PictureScene& s) { s.bodies.resize(1); });
    refused([](PictureScene& s) { s.camera.look_at = s.camera.position; });
    refused([](PictureScene& s) { s.camera.up = Vec3d::UnitY(); });
    refused([](PictureScene& s) { s.camera.field_of_view_deg = 180.0; });
    refused([](PictureScene& s) { s.to_sun = Vec3d::Zero(); });
    const std::vector<Vec4> two(2, Vec4::Zero());
    refused([&](PictureScene& s) { s.velocities = two; });
    CHECK_THROWS_AS(renderer.render(scene, 0, 8, Workers(1)), std::invalid_argument);
    CHECK_THROWS_AS(renderer.render(scene, 8, 20000, Workers(1)), std::invalid_argument);
}

TEST_CASE("a PNG decodes to the picture", "[io][png]")
{
    const Scratch scratch;
    const auto [width, height] = GENERATE(std::pair{1, 1}, std::pair{7, 3}, std::pair{64, 33});
    Image image(width, height);
    for (std::size_t k = 0; k < image.rgb.size(); ++k) image.rgb[k] = static_cast<std::uint8_t>(37 * k % 251);
    write_png(scratch / "a.png", image);
    CHECK(contents(scratch / "a.png").substr(0, 8) == "\x89PNG\r\n\x1a\n");
    const std::vector<std::uint8_t> bytes = png_of(image);
    CHECK(contents(scratch / "a.png") == std::string(bytes.begin(), bytes.end()));

    png_image decoded{};
    decoded.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&decoded, (scratch / "a.png").c_str()) != 0);
    CHECK(decoded.format == PNG_FORMAT_RGB);
    CHECK(decoded.width == static_cast<unsigned>(width));
    CHECK(decoded.height == static_cast<unsigned>(height));
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(decoded));
    REQUIRE(png_image_finish_read(&decoded, nullptr, pixels.data(), 0, nullptr) != 0);
    CHECK(pixels == image.rgb);
}

TEST_CASE("a PNG on a full disk says so", "[io][png]")
{
    CHECK_THROWS_WITH(write_png("/dev/full", Image(64, 64)), "cannot write /dev/full: No space left on device");
    CHECK_THROWS_AS(write_png("/nowhere/a.png", Image(1, 1)), OutputError);
    CHECK_THROWS_AS(write_png("a.png", Image()), std::invalid_argument);
    CHECK_THROWS_AS(png_of(Image()), std::invalid_argument);
}
