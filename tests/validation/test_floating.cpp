#include "support/catch.hpp"
#include "support/scene_run.hpp"

#include <cmath>
#include <sstream>

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kSpacing = 0.02, kSize = 12 * kSpacing; // D/d = 12

/// A body let go with its middle at the water's level, in a tank of 28 x 30 x 16 spacings (2-D: 60 x 30).
RunReport float_body(int dimensions, const std::string& shape, const std::string& more, double ratio, double duration)
{
    const bool plane = dimensions == 2;
    const double x = plane ? 1.2 : 0.56, y = plane ? 0.0 : 0.6, z = plane ? 0.6 : 0.32;
    std::ostringstream size, scene;
    size << "[" << x << ", " << y << ", ";
    scene << R"({"flotsam": 1, "dimensions": )" << dimensions << R"(, "particle_spacing": 0.02, "duration": )"
          << duration << R"(, "fluids": [{"blocks": [{"min": [0, 0, 0], "max": )" << size.str() << z
          << R"(]}]}], "walls": [{"box": {"min": [0, 0, 0], "max": )" << size.str()
          << R"(1], "open": ["+z"]}}], "bodies": [{"name": "body", "shape": )" << shape << R"(, "density": )"
          << 1000.0 * ratio << more << R"(, "position": [)" << x / 2 << ", " << y / 2 << ", " << z << "]}]}";
    return run_text(scene.str());
}

void check_draft(const RunReport& report)
{
    REQUIRE(report.bodies.size() == 1);
    const BodyReport& body = report.bodies[0];
    REQUIRE(body.draft.has_value());
    REQUIRE(body.exact_draft.has_value());
    INFO("draft " << *body.draft << " m, exact " << *body.exact_draft << " m, error "
                  << (*body.draft - *body.exact_draft) / kSpacing << " spacings, tilt " << body.tilt_deg << " deg");
    // It came to rest, but for the water's own motion: 10 s after the drop a disc of 0.75 goes up and down with the
    // standing wave of its tank, at 45 to 73 mm/s (four runs that differ by millimetres or by skin friction).
    CHECK(body.velocity.norm() < 0.08);
    // Half a spacing: where a free surface of particles lies is not known better than that.
    CHECK(std::abs(*body.draft - *body.exact_draft) < std::max(0.03 * kSize, 0.5 * kSpacing));
    CHECK(report.leaked == 0);
}

} // namespace

TEST_CASE("in 2-D a box and a disc float at the draft of Archimedes", "[validation][draft]")
{
    const double ratio = GENERATE(0.25, 0.5, 0.75);
    const std::string shape = GENERATE(R"({"box": [0.24, 0.12]})", R"({"disc": 0.12})");
    CAPTURE(ratio, shape);
    check_draft(float_body(2, shape, "", ratio, 10.0));
}

TEST_CASE("in 3-D a box floats at the draft of Archimedes", "[validation][draft]")
{
    check_draft(float_body(3, R"({"box": [0.24, 0.24, 0.12]})", "", 0.5, 3.0));
}

TEST_CASE("in 3-D a sphere floats at the draft of Archimedes", "[validation][draft]")
{
    check_draft(float_body(3, R"({"sphere": 0.12})", "", 0.25, 3.0));
}

TEST_CASE("in 3-D a lying cylinder floats at the draft of Archimedes", "[validation][draft]")
{
    check_draft(float_body(3, R"({"cylinder": [0.12, 0.48]})", R"(, "rotation_deg": [90, 0, 0])", 0.75, 3.0));
}

TEST_CASE("a box a little lighter than water floats, a little heavier sinks", "[validation][draft]")
{
    const RunReport light = float_body(2, R"({"box": [0.24, 0.24]})", "", 0.95, 4.0);
    CHECK(light.bodies[0].position.z() > 0.6 - 0.24);
    const RunReport heavy = float_body(2, R"({"box": [0.24, 0.24]})", "", 1.05, 6.0);
    CHECK_FALSE(heavy.bodies[0].exact_draft.has_value());
    CHECK(heavy.bodies[0].position.z() < 0.6 - 0.24); // wholly under water, its top by half its height
}
