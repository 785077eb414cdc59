#include "run_program.hpp"
#include "support/catch.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

using namespace flotsam::testing;

namespace {

/// A box of 8 x 1 x 1 about the origin, closed unless its last face is left out.
std::string log_obj(bool is_closed = true)
{
    std::string text;
    for (int k = 0; k < 8; ++k)
        text += std::string("v ") + (k & 1 ? "4" : "-4") + (k & 2 ? " 0.5" : " -0.5") + (k & 4 ? " 0.5\n" : " -0.5\n");
    text += "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\n";
    return is_closed ? text + "f 5 6 8 7\n" : text;
}

nlohmann::json numbers_of(const TemporaryDirectory& directory, const std::string& out)
{
    return nlohmann::json::parse(directory.read(out + "/hydrostatics.json"));
}

} // namespace

TEST_CASE("hydrostatics of a log: table, poses, righting arms and files", "[cli][hydrostatics]")
{
    const TemporaryDirectory directory("flotsam_cli_hydrostatics");
    directory.write("log.obj", log_obj());
    const Outcome done = run_program(directory, "hydrostatics log.obj --density 250 --heel 0:15:60");
    INFO(done.err);
    CHECK(done.code == 0);
    CHECK(done.err.empty());
    for (const char* part : {"draft [m]", "KB [m]", "KG [m]", "waterplane area", "GM about x (heel)", "26.57", "-26.57",
                             "Righting arms", "out/log-hydrostatics", "righting_arm.png"})
        CHECK(contains(done.out, part));

    const auto numbers = numbers_of(directory, "out/log-hydrostatics");
    CHECK(numbers["volume"].get<double>() == Approx(8.0));
    CHECK(numbers["mass"].get<double>() == Approx(2000.0));
    const auto& upright = numbers["as_modelled"];
    CHECK(upright["draft"].get<double>() == Approx(0.25));
    CHECK(upright["keel_to_center_of_buoyancy"].get<double>() == Approx(0.125));
    CHECK(upright["keel_to_center_of_mass"].get<double>() == Approx(0.5));
    CHECK(upright["waterplane"]["area"].get<double>() == Approx(8.0));
    CHECK(upright["metacentric_heights"]["heel"].get<double>() == Approx(0.125 + 1.0 / 3 - 0.5));
    CHECK(upright["metacentric_heights"]["trim"].get<double>() == Approx(0.125 + 64.0 / 3 - 0.5));
    REQUIRE(numbers["stable_poses"].size() == 8);
    CHECK(std::abs(numbers["stable_poses"][0]["heel_deg"].get<double>()) == Approx(26.565).margin(1e-3));
    REQUIRE(numbers["righting_arms"].size() == 5);
    CHECK(numbers["righting_arms"][1]["gz"].get<double>() < 0.0); // it does not stand upright
    CHECK(numbers["righting_arms"][2]["gz"].get<double>() > 0.0);

    const std::string arms = directory.read("out/log-hydrostatics/righting_arm.csv");
    CHECK(contains(arms, "heel_deg,gz_m,draft_m,righting_moment_N_m,energy_J\n0,"));
    CHECK(std::count(arms.begin(), arms.end(), '\n') == 6);
    const std::string poses = directory.read("out/log-hydrostatics/poses.csv");
    CHECK(std::count(poses.begin(), poses.end(), '\n') == 9);
    CHECK(contains(directory.read("out/log-hydrostatics/righting_arm.png"), "PNG"));
    CHECK(run_program(directory, "hydrostatics log.obj --mass 2000").code == 0); // replaces the older output
    CHECK_FALSE(std::filesystem::exists(directory.path() / "out/log-hydrostatics/righting_arm.csv"));
}

TEST_CASE("mass, scale, water and centre of mass change what they should", "[cli][hydrostatics]")
{
    const TemporaryDirectory directory("flotsam_cli_hydrostatics_options");
    directory.write("log.obj", log_obj());
    const auto run = [&](const std::string& options) {
        const Outcome done = run_program(directory, "hydrostatics log.obj --out out " + options);
        INFO(done.err);
        REQUIRE(done.code == 0);
        return numbers_of(directory, "out");
    };
    const auto draft = [](const nlohmann::json& numbers) { return numbers["as_modelled"]["draft"].get<double>(); };
    CHECK(draft(run("--mass 2000")) == Approx(0.25));
    CHECK(draft(run("--density 250 --water-density 500")) == Approx(0.5));
    CHECK(draft(run("--density 250 --scale 0.001")) == Approx(0.00025));
    const auto loaded = run("--density 250 --center 0,0,-0.4");
    CHECK(loaded["as_modelled"]["metacentric_heights"]["heel"].get<double>() == Approx(0.125 + 1.0 / 3 - 0.1));
    CHECK(loaded["stable_poses"].size() == 1);
    const auto listing = run("--density 250 --center 0,-0.1,-0.4"); // heavier on the side that a positive heel lowers
    CHECK(listing["stable_poses"][0]["heel_deg"].get<double>() > 1.0);
    CHECK(listing["as_modelled"]["righting_arms"][0].get<double>() == Approx(-0.1));
}

TEST_CASE("bad input of hydrostatics is one sentence that names option and limits, with code 2", "[cli][hydrostatics]")
{
    const TemporaryDirectory directory("flotsam_cli_hydrostatics_refused");
    directory.write("log.obj", log_obj());
    directory.write("open.obj", log_obj(false));
    std::filesystem::create_directories(directory.path() / "full");
    directory.write("full/thesis.tex", "years of work");
    struct Case {
        const char *arguments, *words;
    };
    const Case cases[] = {
        {"", "MESH is required"},
        {"log.obj", "--density [kg/m^3] or --mass [kg] of the body is missing"},
        {"log.obj --density 1 --mass 1", "--density and --mass cannot both be given"},
        {"log.obj --density 0", "--density: must be a number > 0 [kg/m^3], given \"0\""},
        {"log.obj --density -5", "--density: must be a number > 0 [kg/m^3], given \"-5\""},
        {"log.obj --density nan", "given \"nan\""},
        {"log.obj --density inf", "given \"inf\""},
        {"log.obj --density 1e400", "given \"1e400\""},
        {"log.obj --density 400kg", "given \"400kg\""},
        {"log.obj --density ''", "--density: must be a number"},
        {"log.obj --density", "--density"},
        {"log.obj --mass -1", "--mass: must be a number > 0 [kg]"},
        {"log.obj --mass nan", "--mass: must be a number > 0 [kg]"},
        {"log.obj --mass 1 --water-density 0", "--water-density: must be a number > 0"},
        {"log.obj --mass 1 --water-density x", "--water-density: must be a number > 0"},
        {"log.obj --mass 1 --scale 0", "--scale: must be a number > 0 metres"},
        {"log.obj --mass 1 --center 0,0", "--center: must be three numbers [m]"},
        {"log.obj --mass 1 --center 0,0,0,0", "--center: must be three numbers [m]"},
        {"log.obj --mass 1 --center 0,nan,0", "given \"0,nan,0\""},
        {"log.obj --mass 1 --center 0,,0", "--center: must be three numbers [m]"},
        {"log.obj --mass 1 --heel 30", "--heel: must be START:STEP:END in degrees"},
        {"log.obj --mass 1 --heel 0:a:60", "--heel: must be START:STEP:END in degrees"},
        {"log.obj --mass 1 --heel 0:nan:60", "--heel: must be START:STEP:END in degrees"},
        {"log.obj --mass 1 --heel 0:5:60:1", "--heel: must be START:STEP:END in degrees"},
        {"log.obj --mass 1 --heel 0:0:60", "a step > 0"},
        {"log.obj --mass 1 --heel 0:-5:60", "a step > 0"},
        {"log.obj --mass 1 --heel 60:5:0", "an end that is not before the start"},
        {"log.obj --mass 1 --heel 0:0.001:60", "at most 10000 angles"},
        {"log.obj --mass 1 --heel 0:1e-300:60", "at most 10000 angles"},
        {"log.obj --mass 1 --draft 3", "has no option --draft"},
        {"log.obj --mass 1 --out ''", "--out must be the name of a directory"},
        {"log.obj --mass 1 --out full", "full holds something else"},
        {"none.obj --mass 1", "none.obj\": there is no such file"},
        {"open.obj --mass 1", "open.obj has 4 edges with a triangle on one side only"},
        {"log.obj --density 7850", "log.obj: it sinks"},
        {"log.obj --mass 1e-300", "log.obj: its mass of 1e-300 kg must be at least 1e-09 of the 8000 kg"},
        {"log.obj --mass 8001", "it sinks: its 8001 kg in 8 m^3 are 1000.12 kg/m^3, and the water has 1000 kg/m^3"},
    };
    for (const auto& [arguments, words] : cases) {
        const Outcome refused = run_program(directory, std::string("hydrostatics ") + arguments);
        INFO(arguments << ": " << refused.err);
        CHECK(refused.code == 2);
        CHECK(refused.out.empty());
        CHECK(refused.err.rfind("error: ", 0) == 0);
        CHECK(contains(refused.err, words));
        CHECK(refused.err.find('\n') == refused.err.size() - 1);
        CHECK_FALSE(std::filesystem::exists(directory.path() / "out"));
    }
    CHECK(directory.read("full/thesis.tex") == "years of work");
}

TEST_CASE("hydrostatics of an open boat are with her hollow dry", "[cli][hydrostatics]")
{
    const TemporaryDirectory directory("flotsam_cli_hydrostatics_boat");
    const std::string punt = std::string("hydrostatics ") + FLOTSAM_DATA_DIR + "/meshes/punt.obj --out out ";
    // Steel of 4 mm: her bottom is 0.34 x 0.2 m, 0.5 x 0.28 m at the rim, 0.14 m up. 6 kg at 0.0713 m, by the integral
    // of length times breadth over the height.
    const Outcome heavy = run_program(directory, punt + "--mass 6 --heel 0:5:40");
    CHECK(heavy.code == 0);
    CHECK(contains(heavy.out, "held there, its hollow dry"));
    CHECK(contains(heavy.out, "0.07128"));
    CHECK(contains(heavy.out, "with its hollow open to the water it sinks"));
    CHECK_FALSE(contains(heavy.out, "Stable poses"));
    CHECK(contains(heavy.out, "at a heel of 29.25 degrees water comes over its rim"));
    CHECK(contains(heavy.out, "\n  25.00 "));
    CHECK_FALSE(contains(heavy.out, "\n  30.00 "));
    const auto report = nlohmann::json::parse(directory.read("out/hydrostatics.json"));
    CHECK(report["vessel"] == true);
    CHECK(report["stable_poses"].empty());
    CHECK(report["righting_arms"].size() == 6);
    CHECK(report["flooding_heel_deg"][0].is_null());
    CHECK(report["flooding_heel_deg"][1].get<double>() == Approx(29.25).margin(0.01));
    const Outcome light = run_program(directory, punt + "--density 500");
    CHECK(light.code == 0);
    CHECK(contains(light.out, "0.00711"));
    CHECK(contains(light.out, "Stable poses with its hollow open to the water"));
    const Outcome founders = run_program(directory, punt + "--mass 30");
    CHECK(founders.code == 2);
    CHECK(contains(founders.err, "it sinks: water comes over the rim of its hollow"));
}

TEST_CASE("no water comes into a cavity", "[cli][hydrostatics]")
{
    const TemporaryDirectory directory("flotsam_cli_hydrostatics_cavity");
    std::string text;
    for (const double half : {0.5, 0.4})
        for (const int k : {0, 1, 2, 3, 4, 5, 6, 7})
            text += "v " + std::to_string(k & 1 ? half : -half) + " " + std::to_string(k & 2 ? half : -half) + " " +
                    std::to_string(k & 4 ? half : -half) + "\n";
    text += "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
    text += "f 9 13 15 11\nf 10 12 16 14\nf 9 10 14 13\nf 11 15 16 12\nf 9 11 12 10\nf 13 14 16 15\n";
    directory.write("hollow.obj", text);
    // 0.488 m^3 of steel plate would sink without the cavity; of 800 kg/m^3 it floats on a corner as a cube of 0.39
    // does.
    const Outcome light = run_program(directory, "hydrostatics hollow.obj --density 800 --out light");
    CHECK(light.code == 0);
    CHECK(contains(light.out, "no water comes into its cavities"));
    CHECK_FALSE(contains(light.out, "hollow dry"));
    const auto report = numbers_of(directory, "light");
    CHECK(report["vessel"] == false);
    CHECK(report["stable_poses"].size() == 8);
    const Outcome steel = run_program(directory, "hydrostatics hollow.obj --density 2000 --out steel");
    CHECK(steel.code == 0);
    CHECK(numbers_of(directory, "steel")["as_modelled"]["draft"].get<double>() == Approx(0.976).margin(1e-6));
    const Outcome sinks = run_program(directory, "hydrostatics hollow.obj --density 2100 --out sinks");
    CHECK(sinks.code == 2);
    CHECK(contains(sinks.err, "in 1 m^3 are 1024.8 kg/m^3"));
}

TEST_CASE("without gnuplot everything else is there and one sentence names the package", "[cli][hydrostatics]")
{
    const TemporaryDirectory directory("flotsam_cli_hydrostatics_gnuplot");
    directory.write("log.obj", log_obj());
    const std::string arguments = "hydrostatics log.obj --density 250 --heel 0:5:10 --out out";
    const Outcome done = run_program(directory, arguments, "PATH=/nonexistent");
    CHECK(done.code == 1);
    CHECK(contains(done.err, "righting_arm.png: there is no gnuplot; install the package gnuplot-nox"));
    CHECK(done.err.find('\n') == done.err.size() - 1);
    CHECK(contains(done.out, "26.57"));
    CHECK(std::filesystem::exists(directory.path() / "out/righting_arm.csv"));
    CHECK(std::filesystem::exists(directory.path() / "out/hydrostatics.json"));
    CHECK_FALSE(std::filesystem::exists(directory.path() / "out/righting_arm.png"));
    CHECK(run_program(directory, "hydrostatics log.obj --density 250 --out other", "PATH=/nonexistent").code == 0);
}
