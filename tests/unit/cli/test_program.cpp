#include "../scene/scene_texts.hpp"
#include "run_program.hpp"
#include "support/catch.hpp"

#include <cstdlib>

using namespace flotsam::testing;

TEST_CASE("help says what there is", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_help");
    for (const char* arguments : {"--help", "run --help", "check --help", "hydrostatics --help", "validate --help"}) {
        const Outcome help = run_program(directory, arguments);
        CHECK(help.code == 0);
        CHECK(contains(help.out, "Example"));
        CHECK(help.err.empty());
    }
    CHECK(contains(run_program(directory, "--help").out, "report.json"));
    CHECK(contains(run_program(directory, "--version").out, "flotsam 0."));
}

TEST_CASE("a wrong command line is refused with code 2", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_usage");
    for (const char* arguments :
         {"", "walk", "run", "run a.json --out", "run a.json --threads many", "check --x a", "run a.json --threads -1",
          "run a.json --threads 0", "run a.json --threads 1e9", "run a.json --out ''"}) {
        const Outcome wrong = run_program(directory, arguments);
        INFO(arguments);
        CHECK(wrong.code == 2);
        CHECK(wrong.out.empty());
        CHECK(contains(wrong.err, "error: "));
        CHECK(wrong.err.find('\n') == wrong.err.size() - 1);
    }
    CHECK(contains(run_program(directory, "run a.json --threads x").err, "from 1 to 1024, given \"x\""));
    CHECK(contains(run_program(directory, "walk").err, "there is no command \"walk\""));
    CHECK(contains(run_program(directory, "run a.json --out b --fast").err, "no option --fast"));
}

TEST_CASE("refused input exits with 2 and one sentence, and writes nothing", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_refused");
    directory.write("scene.json", kRaft);
    directory.write("broken.json", "{\"flotsam\": 1,");
    directory.write("newline.json", "{\"flo\\ntsam\": 1}");
    directory.write("file", "");
    for (const char* arguments :
         {"run none.json --out out", "run broken.json --out out", "run scene.json --out out --set bodies.raft.mass=1",
          "run scene.json --out out --set duration=-1", "run scene.json --out out --set particle_spacing=1e-9",
          "run scene.json --out out --set bodies.raft.position=[9,9]", "check broken.json", "check newline.json",
          "run scene.json --out file/out"}) {
        const Outcome refused = run_program(directory, arguments);
        INFO(arguments << ": " << refused.err);
        CHECK(refused.code == 2);
        CHECK(refused.out.empty());
        CHECK(refused.err.rfind("error: ", 0) == 0);
        CHECK(refused.err.find('\n') == refused.err.size() - 1);
        CHECK_FALSE(std::filesystem::exists(directory.path() / "out"));
    }
}

TEST_CASE("run records, prints plain lines and ends in the table of drafts", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_run");
    directory.write("scene.json", kRaft);
    const Outcome run = run_program(directory, "run scene.json --set bodies.raft.density=600 --threads 2");
    INFO(run.err);
    CHECK(run.code == 0);
    CHECK(run.err.empty());
    for (const char* part : {"100 %", "x real time", "raft", "0.600", "out/scene", "report.json"})
        CHECK(contains(run.out, part));
    CHECK_FALSE(contains(run.out, "\r"));
    CHECK(std::filesystem::exists(directory.path() / "out/scene/history.csv"));
    CHECK(run_program(directory, "run scene.json --quiet --out again --threads 2").out.empty());
}

TEST_CASE("run says how water comes to rest before it starts", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_rest");
    directory.write("scene.json", kRaft);
    const Outcome run = run_program(directory, "run scene.json --set start=at_rest --set duration=0.01 --threads 2");
    INFO(run.out << run.err);
    CHECK(run.code == 0);
    CHECK(run.out.rfind("settling the water: round 40 of at most 400, ", 0) == 0);
    CHECK(run.out.find("settling the water") < run.out.find("fluid particles"));
    CHECK_FALSE(contains(run.out, "\r"));
    CHECK(run_program(directory, "run scene.json --set start=at_rest --quiet --out again --threads 2").out.empty());
}

TEST_CASE("check says what a scene holds", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_check");
    directory.write("scene.json", kRaft);
    const Outcome check = run_program(directory, "check scene.json");
    CHECK(check.code == 0);
    CHECK(contains(check.out, "nothing wrong"));
    CHECK(contains(check.out, "raft"));
    CHECK(contains(check.out, "note: "));
}

TEST_CASE("check says what a mesh file is good for", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_check_mesh");
    const std::string open = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
    directory.write("solid.obj", open + "f 2 3 4\n");
    directory.write("open.obj", open);
    const Outcome solid = run_program(directory, "check solid.obj");
    CHECK(solid.code == 0);
    CHECK(contains(solid.out, "4 triangles in 1 part, 1 x 1 x 1 m, volume 0.166667 m^3"));
    const Outcome refused = run_program(directory, "check open.obj");
    CHECK(refused.code == 2);
    CHECK(contains(refused.err, "open.obj has 3 edges with a triangle on one side only"));
    CHECK(run_program(directory, "check solid.obj --set duration=1").code == 2);
}

TEST_CASE("a file that may grow no further is an error, no signal", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_limit");
    directory.write("scene.json", kRaft);
    const std::string command = "cd '" + directory.path().string() +
                                "' && ulimit -f 8 && '" FLOTSAM_PROGRAM
                                "' run scene.json --set output.vtk=true --quiet --out out 2>stderr.txt";
    const int status = std::system(command.c_str());
    INFO(directory.read("stderr.txt"));
    CHECK(WEXITSTATUS(status) == 1);
    CHECK(contains(directory.read("stderr.txt"), ".vtp"));
    CHECK_FALSE(std::filesystem::exists(directory.path() / "out"));
}

TEST_CASE("a run outlives the reader of its output", "[cli]")
{
    const TemporaryDirectory directory("flotsam_cli_pipe");
    directory.write("scene.json", kRaft);
    const std::string command =
        "cd '" + directory.path().string() + "' && '" FLOTSAM_PROGRAM "' run scene.json --out out | true";
    REQUIRE(std::system(command.c_str()) == 0);
    CHECK(std::filesystem::exists(directory.path() / "out/report.json"));
}

TEST_CASE("a full disk ends a run with code 1 and the file's name", "[cli]")
{
    // A file size limit stands for the disk; vtk frames are the first to pass it.
    const TemporaryDirectory directory("flotsam_cli_full");
    directory.write("scene.json", kRaft);
    const std::string command = "cd '" + directory.path().string() +
                                "' && trap '' XFSZ && ulimit -f 8 && '" FLOTSAM_PROGRAM
                                "' run scene.json --set output.vtk=true --quiet --out out 2>stderr.txt";
    const int status = std::system(command.c_str());
    const std::string err = directory.read("stderr.txt");
    INFO(err);
    CHECK(WEXITSTATUS(status) == 1);
    CHECK(contains(err, "error: "));
    CHECK(contains(err, ".vtp"));
    CHECK_FALSE(std::filesystem::exists(directory.path() / "out"));
}
