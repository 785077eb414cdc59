#include "flotsam/core/contracts.hpp"
#include "flotsam/scene/hydrostatics_report.hpp"
#include "support/catch.hpp"
#include "unit/scene/support_directory.hpp"

#include <limits>

using namespace flotsam;

TEST_CASE("a heel range counts its angles, its end among them", "[scene][hydrostatics]")
{
    CHECK(HeelRange{0, 5, 60}.rows() == 13);
    CHECK(HeelRange{0, 0.1, 1}.rows() == 11); // though ten times 0.1 falls short of or beyond one
    CHECK(HeelRange{0, 7, 60}.rows() == 9);
    CHECK(HeelRange{-180, 1, 180}.rows() == 361);
    CHECK(HeelRange{10, 5, 10}.rows() == 1);
    CHECK(HeelRange{0, 1, 9999}.rows() == 10000);
    CHECK(HeelRange{0, 1, 10000}.rows() == 0);
    CHECK(HeelRange{0, 0, 60}.rows() == 0);
    CHECK(HeelRange{0, -1, 60}.rows() == 0);
    CHECK(HeelRange{60, 1, 0}.rows() == 0);
    CHECK(HeelRange{0, std::numeric_limits<double>::quiet_NaN(), 60}.rows() == 0);
    CHECK(HeelRange{0, 1, std::numeric_limits<double>::infinity()}.rows() == 0);
}

TEST_CASE("a request that is out of bounds is the caller's mistake, a mesh that is none is input",
          "[scene][hydrostatics]")
{
    const HydrostaticsRequest good{.mesh = FLOTSAM_DATA_DIR "/meshes/crate.glb", .density = 400.0};
    CHECK(report_hydrostatics(good).as_modelled.draft > 0.0);
    const auto refused = [&](auto change) {
        HydrostaticsRequest request = good;
        change(request);
        CHECK_THROWS_AS(report_hydrostatics(request), std::invalid_argument);
    };
    refused([](auto& request) { request.mass = 1.0; });
    refused([](auto& request) { request.density.reset(); });
    refused([](auto& request) { request.density = 0.0; });
    refused([](auto& request) { request.density = std::numeric_limits<double>::quiet_NaN(); });
    refused([](auto& request) { request.water_density = -1.0; });
    refused([](auto& request) { request.scale = 0.0; });
    refused([](auto& request) { request.heel = HeelRange{0, 0, 1}; });
    refused([](auto& request) { request.center_of_mass = Vec3d::Constant(std::numeric_limits<double>::infinity()); });
    HydrostaticsRequest request = good;
    request.mesh = "none.obj";
    CHECK_THROWS_AS(report_hydrostatics(request), InputError);
    request = good;
    request.density = 1100.0;
    CHECK_THROWS_WITH(report_hydrostatics(request),
                      Catch::Contains("it sinks") && Catch::Contains("1100 kg/m^3") && Catch::Contains("1000 kg/m^3"));
}
