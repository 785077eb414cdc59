#include "flotsam/geometry/hydrostatics.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "flotsam/geometry/shapes.hpp"
#include "support/catch.hpp"
#include "unit/geometry/sample_meshes.hpp"

using namespace flotsam;

namespace {

constexpr double kPi = 3.14159265358979323846;

double draft_of(const TriangleMesh& mesh, double density_ratio, const Quatd& orientation = Quatd::Identity())
{
    const auto draft = equilibrium_draft(mesh, orientation, density_ratio * mass_properties(mesh).volume);
    REQUIRE(draft.has_value());
    return *draft;
}

} // namespace

TEST_CASE("a box is cut exactly, also where the water stands at its vertices", "[geometry][hydrostatics]")
{
    const TriangleMesh box = tessellate(BoxShape{{2, 3, 1}}, 1.0);
    const Pose pose{{7, -4, 10}, Quatd::Identity()};
    const Submerged part = submerged_part(box, pose, 9.8);
    CHECK(part.volume == Approx(6.0 * 0.3).epsilon(1e-13));
    CHECK((part.center_of_buoyancy - Vec3d(7, -4, 9.65)).norm() < 1e-13);
    CHECK(part.waterplane_area == Approx(6.0).epsilon(1e-13));

    CHECK(submerged_part(box, pose, 9.5).volume == 0.0);
    CHECK(submerged_part(box, pose, 9.5).center_of_buoyancy == Vec3d::Zero());
    CHECK(submerged_part(box, pose, 10.5).volume == Approx(6.0).epsilon(1e-13));
    CHECK(submerged_part(box, pose, 20.0).volume == Approx(6.0).epsilon(1e-13));
    CHECK(submerged_part(box, pose, 20.0).waterplane_area == Approx(0.0).margin(1e-13));
    CHECK(lowest_point(box, pose) == 9.5);
}

TEST_CASE("water through the edges of a tilted cube fills half of it", "[geometry][hydrostatics]")
{
    const Pose tilted{{0, 0, 3}, Quatd(Eigen::AngleAxisd(kPi / 4, Vec3d::UnitX()))};
    const Submerged part = submerged_part(tessellate(BoxShape{}, 1.0), tilted, 3.0);
    CHECK(part.volume == Approx(0.5).epsilon(1e-13));
    CHECK(part.center_of_buoyancy.z() == Approx(3.0 - std::sqrt(0.5) / 3.0).epsilon(1e-13));
    CHECK(part.waterplane_area == Approx(std::sqrt(2.0)).epsilon(1e-13));
}

TEST_CASE("submerged volume grows by waterplane area times rise", "[geometry][hydrostatics]")
{
    const TriangleMesh mesh = tessellate(CylinderShape{0.3, 0.8}, 0.1);
    const Pose pose{{0.1, 0.2, 0.3}, Quatd(Eigen::AngleAxisd(0.6, Vec3d(1, 1, 0.2).normalized()))};
    const double level = GENERATE(0.0, 0.2, 0.35, 0.5);
    const double rise = 1e-5;
    const double grown =
        submerged_part(mesh, pose, level + rise).volume - submerged_part(mesh, pose, level - rise).volume;
    const double area = submerged_part(mesh, pose, level).waterplane_area;
    REQUIRE(area > 0.1);
    CHECK(grown / (2 * rise) == Approx(area).epsilon(1e-5)); // the area is piecewise quadratic in the level
}

TEST_CASE("the righting arm of a held box is the tabulated one", "[geometry][hydrostatics]")
{
    struct Row {
        double breadth;
        double heel_deg;
        double arm;
    };
    const Row row = GENERATE(Row{0.30, 5, 0.010945}, Row{0.30, 20, 0.045553}, Row{0.30, 45, 0.047140},
                             Row{0.20, 30, 0.025259}, Row{0.10, 15, -0.002002});
    const TriangleMesh box = tessellate(BoxShape{{row.breadth, 1.0, 0.10}}, 1.0);
    const Quatd heel(Eigen::AngleAxisd(row.heel_deg * kPi / 180, Vec3d::UnitY()));
    const double level = lowest_point(box, {Vec3d::Zero(), heel}) + draft_of(box, 0.5, heel);
    // Turned about +y, the box's +x side goes down, and buoyancy moves to +x if it rights.
    CHECK(submerged_part(box, {Vec3d::Zero(), heel}, level).center_of_buoyancy.x() == Approx(row.arm).margin(1e-6));
}

TEST_CASE("drafts at rest of a sphere and of a lying cylinder", "[geometry][hydrostatics]")
{
    struct Row {
        double ratio;
        double sphere;
        double cylinder;
    };
    const Row row = GENERATE(Row{0.10, 0.1958, 0.1565}, Row{0.25, 0.3264, 0.2980}, Row{0.50, 0.5000, 0.5000},
                             Row{0.75, 0.6736, 0.7020}, Row{0.90, 0.8042, 0.8435});
    const Quatd lying(Eigen::AngleAxisd(kPi / 2, Vec3d::UnitX()));
    // The polygons' outlines lie within 1e-4 of the round ones at these edges; the table has four digits.
    CHECK(draft_of(tessellate(SphereShape{0.5}, 0.02), row.ratio) == Approx(row.sphere).margin(2e-4));
    CHECK(draft_of(tessellate(CylinderShape{0.5, 2.0}, 0.01), row.ratio, lying) == Approx(row.cylinder).margin(2e-4));
    CHECK(draft_of(tessellate(DiscShape{0.5}, 0.01), row.ratio) == Approx(row.cylinder).margin(2e-4));
}

TEST_CASE("a floating box has its density ratio as draft, to the last digits", "[geometry][hydrostatics]")
{
    const double ratio = GENERATE(1e-6, 0.1, 0.3, 0.999, 1.0);
    CHECK(draft_of(tessellate(BoxShape{{1, 2, 0.5}}, 1.0), ratio) == Approx(0.5 * ratio).margin(1e-13));
}

TEST_CASE("the draft displaces what was asked for where the waterplane jumps or vanishes", "[geometry][hydrostatics]")
{
    // A cone-like tip below, a gap without waterplane between two boxes above each other.
    const TriangleMesh lower = tessellate(BoxShape{}, 1.0);
    const TriangleMesh stack =
        joined(lower, transformed(tessellate(BoxShape{{2, 2, 1}}, 1.0), Pose{Vec3d(0, 0, 3), Quatd::Identity()}));
    CHECK(draft_of(stack, 0.9 / 5.0) == Approx(0.9).epsilon(1e-12));
    CHECK(draft_of(stack, 3.0 / 5.0) == Approx(3.5).epsilon(1e-12));
    const double in_gap = draft_of(stack, 1.0 / 5.0);
    CHECK(in_gap > 1.0 - 1e-9);
    CHECK(in_gap < 3.0 + 1e-9);

    const Quatd on_corner = Quatd::FromTwoVectors(Vec3d(1, 1, 1), Vec3d::UnitZ());
    const double ratio = 1e-9; // a tip: volume = sqrt(3)/2 draft^3
    CHECK(draft_of(lower, ratio, on_corner) == Approx(std::cbrt(ratio * 2.0 / std::sqrt(3.0))).epsilon(1e-11));
}

TEST_CASE("what is too heavy sinks, what displaces nothing lies on the water", "[geometry][hydrostatics]")
{
    const TriangleMesh box = tessellate(BoxShape{}, 1.0);
    CHECK_FALSE(equilibrium_draft(box, Quatd::Identity(), 1.001).has_value());
    CHECK(equilibrium_draft(box, Quatd::Identity(), 0.0).value() == 0.0);
    CHECK_THROWS_AS(equilibrium_draft(box, Quatd::Identity(), -1.0), std::invalid_argument);
    CHECK_THROWS_AS(lowest_point(TriangleMesh{}, Pose{}), std::invalid_argument);
}

TEST_CASE("a Wigley hull at its waterline", "[geometry][hydrostatics]")
{
    const TriangleMesh hull = wigley_hull({2.0, 0.4, 0.25}, 80, 80);
    const Submerged part = submerged_part(hull, Pose{}, 0.0);
    // Flat facets on a hull with 80 stations: below 1e-3 of the closed form.
    CHECK(part.volume == Approx(4.0 / 9.0 * 2.0 * 0.4 * 0.25).epsilon(1e-3));
    CHECK(part.waterplane_area == Approx(2.0 / 3.0 * 2.0 * 0.4).epsilon(1e-3));
    CHECK(part.center_of_buoyancy.z() == Approx(-3.0 / 8.0 * 0.25).epsilon(1e-3));
    CHECK(part.center_of_buoyancy.head<2>().norm() < 1e-12);
}

TEST_CASE("a section is cut exactly per metre, whatever the solid's width", "[geometry][hydrostatics]")
{
    const double width = GENERATE(0.1, 1.0, 7.0);
    const TriangleMesh box = tessellate(BoxShape{{2, width, 1}}, 1.0);
    const Pose pose{{7, 0, 10}, Quatd::Identity()};
    const Submerged part = submerged_section(box, pose, 9.8);
    CHECK(part.volume == Approx(2.0 * 0.3).epsilon(1e-13));
    CHECK((part.center_of_buoyancy - Vec3d(7, 0, 9.65)).norm() < 1e-13);
    CHECK(part.waterplane_area == Approx(2.0).epsilon(1e-13));
    CHECK(submerged_section(box, pose, 9.5).volume == 0.0);
    CHECK(submerged_section(box, pose, 20.0).volume == Approx(2.0).epsilon(1e-13));

    // Turned, it is what the solid's part is, per metre.
    const Pose heeled{{1, 0, -2}, Quatd(Eigen::AngleAxisd(0.6, Vec3d::UnitY()))};
    const Submerged section = submerged_section(box, heeled, -1.8), solid = submerged_part(box, heeled, -1.8);
    CHECK(section.volume == Approx(solid.volume / width).epsilon(1e-12));
    CHECK((section.center_of_buoyancy - solid.center_of_buoyancy).norm() < 1e-12);
    CHECK(section.waterplane_area == Approx(solid.waterplane_area / width).epsilon(1e-12));
}
