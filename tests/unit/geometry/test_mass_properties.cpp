#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"

using namespace flotsam;

namespace {

const Pose kAway{{30.0, -20.0, 5.0}, Quatd(Eigen::AngleAxisd(1.1, Vec3d(0.3, -0.5, 0.8).normalized()))};

/// Compares with a solid known about its own centre, here and moved far away.
void check_both(const TriangleMesh& mesh, double volume, const Vec3d& center, const Mat3d& inertia, double tolerance)
{
    const MassProperties here = mass_properties(mesh);
    CHECK(here.volume == Approx(volume).epsilon(tolerance));
    CHECK((here.center_of_mass - center).norm() < tolerance);
    CHECK((here.inertia - inertia).norm() < tolerance * inertia.norm());

    const MassProperties away = mass_properties(transformed(mesh, kAway));
    const Mat3d turn = kAway.orientation.toRotationMatrix();
    CHECK(away.volume == Approx(volume).epsilon(tolerance));
    CHECK((away.center_of_mass - kAway.to_world(center)).norm() < tolerance);
    CHECK((away.inertia - turn * inertia * turn.transpose()).norm() < tolerance * inertia.norm());
}

} // namespace

TEST_CASE("mass properties of a box", "[geometry]")
{
    const Mat3d inertia = Vec3d(4.0 + 9.0, 1.0 + 9.0, 1.0 + 4.0).asDiagonal() * (6.0 / 12.0);
    check_both(tessellate(BoxShape{{1, 2, 3}}, 1.0), 6.0, Vec3d::Zero(), inertia, 1e-12);
}

TEST_CASE("mass properties of a tetrahedron", "[geometry]")
{
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    // Of the unit corner: integral of x^2 = 1/60, of xy = 1/120, about the corner.
    const double x_sq = 1.0 / 60.0 - 1.0 / 96.0;
    const double xy = 1.0 / 120.0 - 1.0 / 96.0;
    Mat3d inertia = Mat3d::Constant(-xy);
    inertia.diagonal().setConstant(2.0 * x_sq);
    check_both(mesh, 1.0 / 6.0, Vec3d::Constant(0.25), inertia, 1e-12);
}

TEST_CASE("mass properties of a sphere", "[geometry]")
{
    const double volume = 4.0 / 3.0 * 3.14159265358979323846;
    // The polyhedron has the sphere's volume, but reaches out a little further: the inertia differs by order edge^2.
    check_both(tessellate(SphereShape{1.0}, 0.05), volume, Vec3d::Zero(), 0.4 * volume * Mat3d::Identity(), 1e-3);
}

TEST_CASE("a hollow solid has the cavity taken out", "[geometry]")
{
    const TriangleMesh hollow = joined(tessellate(BoxShape{{2, 2, 2}}, 1.0), flipped(tessellate(BoxShape{}, 1.0)));
    const MassProperties solid = mass_properties(hollow);
    CHECK(solid.volume == Approx(7.0));
    CHECK(solid.inertia(0, 0) == Approx((8.0 * 8.0 - 1.0 * 2.0) / 12.0));
}

TEST_CASE("an empty or flat mesh has zero volume and a finite centre", "[geometry]")
{
    CHECK(mass_properties(TriangleMesh{}).volume == 0.0);
    const MassProperties sheet = mass_properties(container_box({{0, 0, 0}, {1, 1, 1}}, {"-x", "+x", "-y", "+y", "+z"}));
    CHECK(sheet.volume == 0.0);
    CHECK(sheet.center_of_mass.allFinite());
    CHECK(sheet.inertia == Mat3d::Zero());
}
