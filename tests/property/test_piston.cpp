#include "support/catch.hpp"
#include "support/scene_run.hpp"

#include <sstream>

using namespace flotsam;
using namespace flotsam::test;

TEST_CASE("a heavy piston on a column of water is carried, and not shot out", "[property]")
{
    // The lattice between piston and walls is too dense by half a per cent, and only the piston can give way.
    constexpr double kMass = 100.0, kBottom = 0.5, kThick = 0.15, kBreadth = 0.3, kDuration = 0.3;
    const double frames_per_second = GENERATE(10.0, 100.0, 240.0); // they cut the steps
    CAPTURE(frames_per_second);
    std::ostringstream scene;
    scene << R"({"flotsam": 1, "dimensions": 2, "particle_spacing": 0.0125, "duration": )" << kDuration
          << R"(, "fluids": [{"blocks": [{"min": [0, 0], "max": [0.3, 0.5]}]}],
        "walls": [{"box": {"min": [0, 0], "max": [0.3, 1.1], "open": ["+z"]}}],
        "bodies": [{"name": "piston", "shape": {"box": [0.294, 0.15]}, "mass": 100, "position": [0.15, 0.575],
                    "friction": 0}],
        "joints": [{"name": "guide", "type": "slider", "a": "piston", "point": [0.15, 0.575], "axis": [0, 1]}],
        "probes": [{"name": "middle", "pressure": [0.15, 0.25]}],
        "output": {"frames_per_second": )"
          << frames_per_second << "}}";
    const RunReport report = run_text(scene.str());
    const BodyReport& piston = report.bodies.at(0);
    CHECK(std::abs(piston.position.z() - (kBottom + 0.5 * kThick)) < 0.005);
    CHECK(std::abs(piston.velocity.z()) < 0.1);
    const double exact = kMass * 9.81 / kBreadth + 1000.0 * 9.81 * 0.25;
    CHECK(report.probes.at(0).mean.value_or(0.0) == Approx(exact).epsilon(0.03));
}
