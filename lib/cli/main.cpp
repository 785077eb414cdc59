#include "cli/arguments.hpp"
#include "cli/progress.hpp"
#include "cli/summary.hpp"
#include "flotsam/core/contracts.hpp"

#include <unistd.h>

#include <exception>
#include <iostream>
#include <new>

namespace flotsam::cli {
namespace {

enum ExitCode { kDone = 0, kRunFailed = 1, kInputRefused = 2 };

void run(const Arguments& arguments)
{
    const SceneFile scene = read_scene(arguments.scene, arguments.overrides);
    Progress progress(std::cout, isatty(STDOUT_FILENO) != 0);
    NoProgress silence;
    RunObserver& observer = arguments.quiet ? static_cast<RunObserver&>(silence) : progress;
    const RunReport report = run_scene(scene, {arguments.out, arguments.threads}, observer);
    if (!arguments.quiet) print_summary(std::cout, report, arguments.out);
}

void check(const Arguments& arguments)
{
    const SceneFile scene = read_scene(arguments.scene, arguments.overrides);
    print_check(std::cout, check_scene(scene), arguments.scene);
}

int exit_code_of(const Arguments& arguments)
{
    try {
        arguments.verb == Arguments::Verb::run ? run(arguments) : check(arguments);
        return kDone;
    } catch (const InputError& error) {
        std::cerr << "error: " << error.what() << std::endl;
        return kInputRefused;
    } catch (const std::bad_alloc&) {
        std::cerr << "error: " << arguments.scene.string() << ": the memory ran out; use a larger particle_spacing"
                  << std::endl;
        return kRunFailed;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << std::endl;
        return kRunFailed;
    }
}

} // namespace
} // namespace flotsam::cli

int main(int argc, char** argv)
{
    const auto parsed = flotsam::cli::parse_arguments(argc, argv);
    return parsed.arguments ? flotsam::cli::exit_code_of(*parsed.arguments) : parsed.exit_code;
}
