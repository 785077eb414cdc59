#include "flotsam/geometry/hydrostatics.hpp"
#include "flotsam/geometry/load_mesh.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "support/catch.hpp"

#include <numbers>

using namespace flotsam;

namespace {

TriangleMesh checked(const std::string& name)
{
    TriangleMesh mesh = load_mesh(std::string(FLOTSAM_DATA_DIR "/meshes/") + name);
    const MeshCheckReport report = check_mesh(mesh, {.name = name, .particle_spacing = 0.02});
    INFO(name);
    CHECK(report.closed);
    CHECK(report.parts == 1);
    CHECK(report.flipped_triangles == 0);
    CHECK(report.dropped_triangles == 0);
    return mesh;
}

} // namespace

TEST_CASE("the hull in data/ is Wigley's below the water and upright above it", "[geometry][data]")
{
    const TriangleMesh hull = checked("hull.obj");
    constexpr double length = 0.60, breadth = 0.16, draft = 0.08, freeboard = 0.06;
    const Submerged wet = submerged_part(hull, Pose{}, 0.0);
    // Facets cut the curved side short: by about (edge / length)^2 along and (edge / draft)^2 across.
    CHECK(wet.volume == Approx(4.0 / 9.0 * length * breadth * draft).epsilon(0.01));
    CHECK(wet.center_of_buoyancy.z() == Approx(-3.0 / 8.0 * draft).epsilon(0.01));
    CHECK(wet.waterplane_area == Approx(2.0 / 3.0 * length * breadth).epsilon(0.002));
    const double dry = 2.0 / 3.0 * length * breadth * freeboard;
    CHECK(mass_properties(hull).volume - wet.volume == Approx(dry).epsilon(0.002));
}

TEST_CASE("the ring buoy in data/ is a torus", "[geometry][data]")
{
    const MassProperties ring = mass_properties(checked("ring_buoy.stl"));
    constexpr double major = 0.10, minor = 0.035, pi = std::numbers::pi;
    CHECK(ring.volume == Approx(2.0 * pi * pi * major * minor * minor).epsilon(0.03)); // of a polygon of 16 sides
    CHECK(ring.center_of_mass.norm() < 1e-6);
}

TEST_CASE("the channel marker in data/ has most of its volume in the float", "[geometry][data]")
{
    const TriangleMesh marker = checked("channel_marker.ply");
    const double volume = mass_properties(marker).volume;
    const double in_float = submerged_part(marker, Pose{}, 0.075).volume - submerged_part(marker, Pose{}, -0.04).volume;
    CHECK(in_float > 0.6 * volume);
    CHECK(bounds(marker).min.z() == Approx(-0.16));
    CHECK(bounds(marker).max.z() == Approx(0.24));
}

TEST_CASE("the crate in data/ is a box without its edges", "[geometry][data]")
{
    const TriangleMesh crate = checked("crate.glb");
    const MassProperties mass = mass_properties(crate);
    const Vec3d size = bounds(crate).size();
    CHECK((size - Vec3d(0.16, 0.12, 0.12)).norm() < 1e-6);
    constexpr double bevel = 0.008, inset = 2.0 * bevel;
    const double edges = 4.0 * (size - Vec3d::Constant(inset)).sum() * 0.5 * bevel * bevel;
    const double corners = 8.0 * 5.0 / 6.0 * bevel * bevel * bevel; // a cube less the tetrahedron that stays
    CHECK(mass.volume == Approx(size.prod() - edges - corners).epsilon(1e-5));
    CHECK(mass.center_of_mass.norm() < 1e-6);
}
