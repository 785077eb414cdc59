#include "cli/arguments.hpp"

#include "cli/hydrostatics_arguments.hpp"
#include "flotsam/version.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
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
  flotsam hydrostatics data/meshes/hull.obj --density 400 --heel 0:5:90
  flotsam validate --quick

A run writes DIR/report.json (what happened, in numbers), DIR/history.csv (a row per frame) and, where the scene's
"output" asks for them, DIR/particles.pvd and DIR/bodies.pvd for ParaView and DIR/pictures/*.png. An older output in DIR
is replaced when the run is done, if nothing else is there.

Exit codes: 0 done, 1 the run failed, 2 the input was refused.)";

std::string thread_fault(std::string& word)
{
    int threads = 0;
    const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), threads);
    const bool is_whole = failed == std::errc() && end == word.data() + word.size();
    if (is_whole && threads >= 1 && threads <= 1024) return {};
    return "must be a whole number from 1 to 1024, given \"" + word + "\"";
}

void add_scene(CLI::App& command, Arguments& arguments, const char* file)
{
    command.add_option("SCENE", arguments.scene, file)->required();
    command
        .add_option("--set", arguments.overrides,
                    "Replaces a value of the scene: a path with dots, indices or names, and a value in JSON (or plain "
                    "text), like bodies.crate.density=300 or gravity=[0,0,-1.6]; may be given several times")
        ->type_name("PATH=VALUE")
        ->expected(1)
        ->take_all();
}

void add_out_and_threads(CLI::App& command, Arguments& arguments, const char* out)
{
    command.add_option("--out", arguments.out, out)->type_name("DIR");
    command
        .add_option("--threads", arguments.threads,
                    "Threads to use, from 1 to 1024 [all the machine has]. Results do not depend on it")
        ->type_name("N")
        ->check(CLI::Validator(&thread_fault, ""));
}

void add_run(CLI::App& app, Arguments& arguments)
{
    CLI::App* run = app.add_subcommand("run", "Run a scene and record it");
    add_scene(*run, arguments, "Scene file (JSON)");
    add_out_and_threads(*run, arguments, "Directory of the results [out/ and the scene's name]");
    run->add_flag("--quiet,-q", arguments.quiet, "Print nothing but errors");
    run->footer("Example:\n  flotsam run data/scenes/cube_in_tank.json --out out/cube --threads 2");
    run->callback([&arguments] { arguments.verb = Arguments::Verb::run; });
}

void add_check(CLI::App& app, Arguments& arguments)
{
    CLI::App* check = app.add_subcommand(
        "check", "Say what is wrong with a scene and its meshes, or with a mesh, without running it");
    add_scene(*check, arguments, "Scene file (JSON), or mesh file (OBJ, STL, PLY, DAE, glTF, GLB)");
    check->footer("Examples:\n  flotsam check data/scenes/harbor.json --set particle_spacing=0.01\n"
                  "  flotsam check data/meshes/hull.obj");
    check->callback([&arguments] { arguments.verb = Arguments::Verb::check; });
}

void add_validate(CLI::App& app, Arguments& arguments)
{
    CLI::App* validate = app.add_subcommand("validate", "Compare the simulation with theory and experiment");
    validate->add_option("NAME", arguments.cases, "Cases to run [all]");
    validate->add_flag("--quick", arguments.quick, "Coarser, and fewer cases: minutes instead of an hour");
    add_out_and_threads(*validate, arguments, "Directory of the report [out/validation]");
    validate->footer("Example:\n  flotsam validate square_log righting_arm --out out/validation\n\n"
                     "Ends with 1 if a check lies outside its band.");
    validate->callback([&arguments] { arguments.verb = Arguments::Verb::validate; });
}

/// Of the directory of results in out/.
std::filesystem::path default_name(const Arguments& arguments)
{
    std::filesystem::path name = arguments.scene.stem();
    if (arguments.verb == Arguments::Verb::validate) name = "validation";
    if (arguments.verb == Arguments::Verb::hydrostatics) name += "-hydrostatics";
    return name;
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
        return argc < 2 ? std::string("a command is missing: run, check, hydrostatics or validate")
                        : std::string("there is no command \"") + argv[1] +
                              "\"; there are run, check, hydrostatics and validate";
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
    add_hydrostatics(app, arguments);
    add_validate(app, arguments);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return {std::nullopt, app.exit(error)}; // help, version
        std::cerr << "error: " << reason(app, error, argc, argv) << "; flotsam --help says what there is\n";
        return {std::nullopt, 2};
    }
    const bool is_hydrostatics = arguments.verb == Arguments::Verb::hydrostatics;
    const std::string fault = is_hydrostatics ? fault_between_options(arguments.hydrostatics) : std::string();
    const CLI::Option* out = app.get_subcommands().front()->get_option_no_throw("--out");
    const bool names_out = out != nullptr && out->count() > 0;
    const bool is_out_empty = names_out && arguments.out.empty();
    if (!fault.empty() || is_out_empty) {
        std::cerr << "error: " << (fault.empty() ? "--out must be the name of a directory and is empty" : fault)
                  << "\n";
        return {std::nullopt, 2};
    }
    if (!names_out) arguments.out = std::filesystem::path("out") / default_name(arguments);
    return {arguments, 0};
}

} // namespace flotsam::cli
