#include "support/catch.hpp"

#include "flotsam/io/output_error.hpp"
#include "flotsam/io/vtk.hpp"
#include "unit/io/vtp_reader.hpp"

#include <limits>
#include <numbers>

using namespace flotsam;

namespace {

FluidState water(std::size_t count)
{
    FluidState fluid;
    for (std::size_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>(i);
        fluid.position.emplace_back(x, -2.0f * x, 0.25f, 99.0f);
        fluid.velocity.emplace_back(3.0f * x, 0.0f, 4.0f * x, 0.0f);
        fluid.density.push_back(1000.0f + x);
        fluid.pressure.push_back(-x);
        fluid.id.push_back(static_cast<std::uint32_t>(count - i));
    }
    return fluid;
}

TriangleMesh triangle()
{
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TriangleMesh tetrahedron()
{
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
}

} // namespace

TEST_CASE("particles read back from their frame", "[io][vtk]")
{
    const std::size_t count = GENERATE(0, 1, 2, 1001);
    const Scratch scratch;
    const FluidState fluid = water(count);
    write_particles_vtp(scratch / "p.vtp", fluid);
    const VtpReader vtp(scratch / "p.vtp");

    CHECK(vtp.tag("VTKFile").at("type") == "PolyData");
    CHECK(vtp.tag("VTKFile").at("version") == "1.0"); // the first that knows header_type
    CHECK(vtp.tag("VTKFile").at("header_type") == "UInt64");
    CHECK(vtp.tag("VTKFile").at("byte_order") ==
          (std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian"));
    CHECK(vtp.count("Points") == count);
    CHECK(vtp.count("Verts") == count);
    CHECK(vtp.count("Polys") == 0);
    CHECK(vtp.array("Points").section == "Points");
    CHECK(vtp.array("Points").components == 3);
    CHECK(vtp.array("velocity").components == 3);
    CHECK(vtp.array("connectivity").section == "Verts");
    CHECK(vtp.tag("PointData").at("Vectors") == "velocity");
    CHECK(vtp.values<float>("density") == fluid.density);
    CHECK(vtp.values<float>("pressure") == fluid.pressure);
    CHECK(vtp.values<std::uint32_t>("id") == fluid.id);

    const auto points = vtp.values<float>("Points");
    const auto velocity = vtp.values<float>("velocity");
    const auto speed = vtp.values<float>("speed");
    const auto connectivity = vtp.values<std::int32_t>("connectivity");
    const auto offsets = vtp.values<std::int32_t>("offsets");
    REQUIRE(points.size() == 3 * count);
    REQUIRE(velocity.size() == 3 * count);
    REQUIRE(speed.size() == count);
    REQUIRE(connectivity.size() == count);
    REQUIRE(offsets.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(Vec3(points[3 * i], points[3 * i + 1], points[3 * i + 2]) == fluid.position[i].head<3>());
        CHECK(velocity[3 * i + 2] == fluid.velocity[i].z());
        CHECK(speed[i] == Approx(5.0 * static_cast<double>(i)));
        CHECK(connectivity[i] == static_cast<std::int32_t>(i));
        CHECK(offsets[i] == static_cast<std::int32_t>(i) + 1);
    }
}

TEST_CASE("bodies stand in their frame where their poses put them", "[io][vtk]")
{
    const Scratch scratch;
    const TriangleMesh first = triangle();
    const TriangleMesh second = tetrahedron();
    const Pose quarter_turn{{10, 0, 0}, Quatd(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3d::UnitZ()))};
    const std::vector<PlacedMesh> bodies = {{&first, {}}, {&second, quarter_turn}};
    write_bodies_vtp(scratch / "b.vtp", bodies);
    const VtpReader vtp(scratch / "b.vtp");

    CHECK(vtp.count("Points") == 7);
    CHECK(vtp.count("Polys") == 5);
    CHECK(vtp.count("Verts") == 0);
    CHECK(vtp.array("connectivity").section == "Polys");
    CHECK(vtp.array("body").section == "CellData");
    CHECK(vtp.values<std::int32_t>("body") == std::vector<std::int32_t>{0, 1, 1, 1, 1});
    CHECK(vtp.values<std::int32_t>("offsets") == std::vector<std::int32_t>{3, 6, 9, 12, 15});
    CHECK(vtp.values<std::int32_t>("connectivity") ==
          std::vector<std::int32_t>{0, 1, 2, 3, 5, 4, 3, 4, 6, 4, 5, 6, 5, 3, 6});
    const auto points = vtp.values<double>("Points");
    REQUIRE(points.size() == 21);
    const Vec3d moved(points[12], points[13], points[14]); // (1, 0, 0) of the second
    CHECK((moved - Vec3d(10, 1, 0)).norm() < 1e-14);       // rounding of one rotation
}

TEST_CASE("a frame without bodies is whole", "[io][vtk]")
{
    const Scratch scratch;
    write_bodies_vtp(scratch / "b.vtp", {});
    CHECK(VtpReader(scratch / "b.vtp").count("Polys") == 0);
    const std::vector<PlacedMesh> missing(1);
    CHECK_THROWS_AS(write_bodies_vtp(scratch / "c.vtp", missing), std::invalid_argument);
}

TEST_CASE("boundary samples read back from their frame", "[io][vtk]")
{
    const Scratch scratch;
    BoundaryState boundary;
    boundary.position = {Vec4(1, 2, 3, 0.5f), Vec4(4, 5, 6, 0.25f)};
    boundary.velocity = {Vec4(7, 8, 9, 0), Vec4::Zero()};
    boundary.owner = {0, 2};
    boundary.position_body.resize(2);
    write_boundary_vtp(scratch / "s.vtp", boundary);
    const VtpReader vtp(scratch / "s.vtp");
    CHECK(vtp.values<float>("Points") == std::vector<float>{1, 2, 3, 4, 5, 6});
    CHECK(vtp.values<float>("velocity") == std::vector<float>{7, 8, 9, 0, 0, 0});
    CHECK(vtp.values<float>("volume") == std::vector<float>{0.5f, 0.25f});
    CHECK(vtp.values<std::int32_t>("owner") == boundary.owner);
}

TEST_CASE("a frame on a full disk says so", "[io][vtk]")
{
    CHECK_THROWS_AS(write_particles_vtp("/dev/full", water(3)), OutputError);
    CHECK_THROWS_WITH(write_particles_vtp("/dev/full", water(100000)),
                      "cannot write /dev/full: No space left on device");
    CHECK(std::filesystem::exists("/dev/full"));
    CHECK_THROWS_WITH(write_particles_vtp("/nowhere/p.vtp", water(3)),
                      "cannot write /nowhere/p.vtp: No such file or directory");
}

TEST_CASE("the collection is whole after every frame", "[io][vtk]")
{
    const Scratch scratch;
    const std::string start = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    const std::string end = "</Collection>\n</VTKFile>\n";
    const std::string first = "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"frames/0.vtp\"/>\n";
    const std::string second = "<DataSet timestep=\"0.1\" group=\"\" part=\"0\" file=\"a &amp; &quot;b&quot;.vtp\"/>\n";
    PvdSeries series(scratch / "water.pvd");
    series.add(0.0, "frames/0.vtp");
    CHECK(contents(scratch / "water.pvd") == start + first + end);
    series.add(0.1, "a & \"b\".vtp");
    CHECK(contents(scratch / "water.pvd") == start + first + second + end);
    CHECK(series.size() == 2);
    CHECK_THROWS_AS(series.add(std::numeric_limits<double>::quiet_NaN(), "x.vtp"), std::invalid_argument);
    CHECK(series.size() == 2);
    CHECK(scratch.entries() == 1);
}
