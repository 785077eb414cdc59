#include "cli/hydrostatics_arguments.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>

namespace flotsam::cli {
namespace {

std::optional<double> finite_number(const std::string& word)
{
    double value = 0.0;
    const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_whole = failed == std::errc() && end == word.data() + word.size();
    return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The numbers between the separators; nothing unless there are three.
std::optional<std::array<double, 3>> three_numbers(const std::string& word, char separator)
{
    std::array<double, 3> numbers{};
    std::size_t begin = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t end = k < 2 ? word.find(separator, begin) : word.size();
        if (end == std::string::npos) return std::nullopt;
        const auto number = finite_number(word.substr(begin, end - begin));
        if (!number) return std::nullopt;
        numbers[k] = *number;
        begin = end + 1;
    }
    return numbers;
}

[[noreturn]] void refuse(const std::string& option, const std::string& allowed, const std::string& word)
{
    throw CLI::ValidationError(option, "must be " + allowed + ", given \"" + word + "\"");
}

/// An option whose number is > 0; `set` takes it.
template <class Set>
CLI::Option* add_positive(CLI::App& command, const std::string& option, const std::string& unit, const char* help,
                          Set set)
{
    const auto read = [option, unit, set](const std::string& word) {
        const auto number = finite_number(word);
        if (!number || !(*number > 0.0)) refuse(option, "a number > 0 " + unit, word);
        set(*number);
    };
    return command.add_option_function<std::string>(option, read, help);
}

Vec3d center(const std::string& word)
{
    const auto numbers = three_numbers(word, ',');
    if (!numbers) refuse("--center", "three numbers [m] with commas between them, like 0,0,-0.05", word);
    return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

HeelRange heel_range(const std::string& word)
{
    const auto numbers = three_numbers(word, ':');
    if (!numbers) refuse("--heel", "START:STEP:END in degrees, like 0:5:60", word);
    const HeelRange range{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    if (!(range.step_deg > 0.0)) refuse("--heel", "START:STEP:END with a step > 0 degrees", word);
    if (!(range.end_deg >= range.start_deg))
        refuse("--heel", "START:STEP:END with an end that is not before the start", word);
    if (range.rows() == 0)
        refuse("--heel", "START:STEP:END of at most " + std::to_string(HeelRange::kMostRows) + " angles", word);
    return range;
}

void add_body(CLI::App& command, HydrostaticsRequest& request)
{
    add_positive(command, "--density", "[kg/m^3]", "Density of the body as a whole; this or --mass",
                 [&request](double value) { request.density = value; })
        ->type_name("KG/M^3");
    add_positive(command, "--mass", "[kg]", "Mass of the body; this or --density", [&request](double value) {
        request.mass = value;
    })->type_name("KG");
    add_positive(command, "--water-density", "[kg/m^3]", "Density of the water [1000]", [&request](double value) {
        request.water_density = value;
    })->type_name("KG/M^3");
    add_positive(command, "--scale", "metres per unit of the file", "Metres per unit of the mesh file [1]",
                 [&request](double value) { request.scale = value; })
        ->type_name("METRES");
    command
        .add_option_function<std::string>(
            "--center", [&request](const std::string& word) { request.center_of_mass = center(word); },
            "Centre of mass in the axes of the mesh file, in metres [that of the uniform solid]")
        ->type_name("X,Y,Z");
}

} // namespace

void add_hydrostatics(CLI::App& app, Arguments& arguments)
{
    HydrostaticsRequest& request = arguments.hydrostatics;
    CLI::App* command = app.add_subcommand(
        "hydrostatics", "Say exactly how a body floats: draft, stability, righting arms and all stable poses");
    command->add_option("MESH", request.mesh, "Mesh file of the body, closed (OBJ, STL, PLY, DAE, glTF, GLB)")
        ->required();
    add_body(*command, request);
    command
        ->add_option_function<std::string>(
            "--heel", [&request](const std::string& word) { request.heel = heel_range(word); },
            "Righting arms at these heel angles about the x axis, in degrees")
        ->type_name("START:STEP:END");
    command->add_option("--out", arguments.out, "Directory of the results [out/ and the mesh's name and -hydrostatics]")
        ->type_name("DIR");
    command->footer(
        "Example:\n  flotsam hydrostatics data/meshes/hull.obj --density 400 --center 0,0,-0.04 --heel 0:5:90\n\n"
        "Writes DIR/hydrostatics.json (all numbers), DIR/poses.csv and, with --heel, DIR/righting_arm.csv and\n"
        "DIR/righting_arm.png (drawn by gnuplot). Z is up in the mesh file.");
    command->callback([&arguments, &request] {
        arguments.verb = Arguments::Verb::hydrostatics;
        arguments.scene = request.mesh;
    });
}

std::string fault_between_options(const HydrostaticsRequest& request)
{
    if (request.density && request.mass)
        return "--density and --mass cannot both be given; each follows from the other";
    if (!request.density && !request.mass) return "--density [kg/m^3] or --mass [kg] of the body is missing";
    return {};
}

} // namespace flotsam::cli
