#include "cli/arguments.hpp"
#include "cli/hydrostatics_summary.hpp"
#include "cli/progress.hpp"
#include "cli/summary.hpp"
#include "cli/validate.hpp"
#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_error.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>

namespace flotsam::cli {
namespace {

enum ExitCode { kDone = 0, kRunFailed = 1, kInputRefused = 2 };

/// One sentence on one line, whatever names of files and keys hold.
void print_error(std::string sentence)
{
    std::replace_if(
        sentence.begin(), sentence.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    std::cerr << "error: " << sentence << std::endl;
}

void run(const Arguments& arguments)
{
    const SceneFile scene = read_scene(arguments.scene, arguments.overrides);
    Progress progress(std::cout, isatty(STDOUT_FILENO) != 0);
    SilentObserver silence;
    RunObserver& observer = arguments.quiet ? static_cast<RunObserver&>(silence) : progress;
    const RunReport report = run_scene(scene, {arguments.out, arguments.threads}, observer);
    if (!arguments.quiet) print_summary(std::cout, report, arguments.out);
}

void check(const Arguments& arguments)
{
    if (is_mesh_file_name(arguments.scene)) {
        if (!arguments.overrides.empty())
            throw InputError(arguments.scene.string() + ": --set changes values of scenes, and this is a mesh file");
        print_check(std::cout, check_mesh_file(arguments.scene), arguments.scene);
        return;
    }
    const SceneFile scene = read_scene(arguments.scene, arguments.overrides);
    print_check(std::cout, check_scene(scene), arguments.scene);
}

void hydrostatics(const Arguments& arguments)
{
    const HydrostaticsReport report = report_hydrostatics(arguments.hydrostatics);
    const std::string not_drawn = write_hydrostatics(report, arguments.out);
    print_hydrostatics(std::cout, report, arguments.out);
    if (!not_drawn.empty()) throw OutputError(not_drawn);
}

ExitCode obey(const Arguments& arguments)
{
    switch (arguments.verb) {
    case Arguments::Verb::run:
        run(arguments);
        break;
    case Arguments::Verb::check:
        check(arguments);
        break;
    case Arguments::Verb::hydrostatics:
        hydrostatics(arguments);
        break;
    case Arguments::Verb::validate:
        return validate(std::cout, arguments) == 0 ? kDone : kRunFailed;
    }
    return kDone;
}

int exit_code_of(const Arguments& arguments)
{
    try {
        return obey(arguments);
    } catch (const InputError& error) {
        print_error(error.what());
        return kInputRefused;
    } catch (const std::bad_alloc&) {
        const bool has_spacing = arguments.verb != Arguments::Verb::hydrostatics;
        print_error(arguments.scene.string() + ": the memory ran out" +
                    (has_spacing ? "; use a larger particle_spacing" : ""));
        return kRunFailed;
    } catch (const std::exception& error) {
        print_error(error.what());
        return kRunFailed;
    }
}

} // namespace
} // namespace flotsam::cli

int main(int argc, char** argv)
{
    // A reader of the output that went away and a file that may grow no further are errors of a write, not of the
    // program: a run that has gone for hours is recorded all the same, or ends in a sentence.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    const auto parsed = flotsam::cli::parse_arguments(argc, argv);
    return parsed.arguments ? flotsam::cli::exit_code_of(*parsed.arguments) : parsed.exit_code;
}
