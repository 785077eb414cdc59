#include "cli/arguments.hpp"

#include "flotsam/version.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

namespace flotsam::cli {
namespace {

constexpr const char* kDescription = "flotsam: water for rigid-body worlds. Runs scenes of an SPH fluid and the bodies "
                                     "that float in it.";

constexpr const char* kFooter = R"(
Examples:
  flotsam run data/scenes/harbor.json --out out/harbor
  flotsam run data/scenes/raft_2d.json --set bodies.raft.density=300 --set duration=2
  flotsam run data/scenes/dam_break.json --set output.vtk=true --set 'output.pictures={"width": 640, "height": 360}'
  flotsam check my_scene.json

A run writes DIR/report.json (what happened, in numbers), DIR/history.csv (a row per frame) and, where the scene's
"output" asks for them, DIR/particles.pvd and DIR/bodies.pvd for ParaView and DIR/pictures/*.png. An older output in DIR
is replaced when the run is done.

Exit codes: 0 done, 1 the run failed, 2 the input was refused.)";

void add_scene(CLI::App& command, Arguments& arguments)
{
    command.add_option("SCENE", arguments.scene, "Scene file (JSON)")->required();
    command
        .add_option("--set", arguments.overrides,
                    "Replaces a value of the scene: a path with dots, indices or names, and a value in JSON (or plain "
                    "text), like bodies.crate.density=300 or gravity=[0,0,-1.6]; may be given several times")
        ->type_name("PATH=VALUE")
        ->expected(1)
        ->take_all();
}

void add_run(CLI::App& app, Arguments& arguments)
{
    CLI::App* run = app.add_subcommand("run", "Run a scene and record it");
    add_scene(*run, arguments);
    run->add_option("--out", arguments.out, "Directory of the results [out/ and the scene's name]")->type_name("DIR");
    run->add_option("--threads", arguments.threads,
                    "Threads to use; 0: all the machine has. Results do not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    run->add_flag("--quiet,-q", arguments.quiet, "Print nothing but errors");
    run->footer("Example:\n  flotsam run data/scenes/cube_in_tank.json --out out/cube --threads 2");
    run->callback([&arguments] { arguments.verb = Arguments::Verb::run; });
}

void add_check(CLI::App& app, Arguments& arguments)
{
    CLI::App* check = app.add_subcommand("check", "Say what is wrong with a scene or its meshes, without running it");
    add_scene(*check, arguments);
    check->footer("Example:\n  flotsam check data/scenes/harbor.json --set particle_spacing=0.01");
    check->callback([&arguments] { arguments.verb = Arguments::Verb::check; });
}

/// What is wrong with the command line; CLI11 does not say which word it was.
std::string reason(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv)
{
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
        for (const CLI::App* command : app.get_subcommands())
            for (const std::string& word : command->remaining())
                if (word.rfind('-', 0) == 0)
                    return "flotsam " + command->get_name() + " has no option " + word.substr(0, word.find('='));
    if (app.get_subcommands().empty())
        return argc < 2 ? std::string("a command is missing: run or check")
                        : std::string("there is no command \"") + argv[1] + "\"; there are run and check";
    return error.what();
}

} // namespace

Parsed parse_arguments(int argc, char** argv)
{
    Arguments arguments;
    CLI::App app(kDescription, "flotsam");
    app.set_version_flag("--version", std::string("flotsam ") + kVersion, "Print the version");
    app.require_subcommand(1);
    app.footer(kFooter);
    add_run(app, arguments);
    add_check(app, arguments);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return {std::nullopt, app.exit(error)}; // help, version
        std::cerr << "error: " << reason(app, error, argc, argv) << "; flotsam --help says what there is\n";
        return {std::nullopt, 2};
    }
    const bool names_out = app.get_subcommand("run")->count("--out") > 0;
    if (names_out && arguments.out.empty()) {
        std::cerr << "error: --out must be the name of a directory and is empty\n";
        return {std::nullopt, 2};
    }
    if (!names_out) arguments.out = std::filesystem::path("out") / arguments.scene.stem();
    return {arguments, 0};
}

} // namespace flotsam::cli
