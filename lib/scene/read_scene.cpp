#include "flotsam/core/contracts.hpp"
#include "flotsam/scene/scene_file.hpp"
#include "scene/history_columns.hpp"
#include "scene/read_parts.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

namespace flotsam {
namespace scene {
namespace {

/// Beyond these somebody misread a unit, and the run would not end.
constexpr double kMostSteps = 1e9;
constexpr double kMostFrames = 1e6;

void read_version(const JsonObject& root)
{
    const JsonNode version = root.required("flotsam");
    if (!(version.json().is_number_integer() && version.json() == 1))
        version.refuse_value("is the version of the scene format and must be 1");
}

PressureSettings read_pressure(const JsonNode& node)
{
    using Settings = PressureSettings;
    const JsonObject object(node,
                            {"solver", "source", "coupling", "tolerance", "velocity_tolerance", "max_iterations"});
    Settings settings;
    if (const auto solver = object.find("solver"))
        settings.solver =
            std::array{Settings::Solver::iisph, Settings::Solver::mprgp}[solver->one_of({"iisph", "mprgp"})];
    if (const auto source = object.find("source"))
        settings.source =
            std::array{Settings::Source::split, Settings::Source::published}[source->one_of({"split", "published"})];
    if (const auto coupling = object.find("coupling"))
        settings.coupling =
            std::array{Settings::Coupling::strong, Settings::Coupling::weak}[coupling->one_of({"strong", "weak"})];
    object.read("tolerance", settings.tolerance, kPositive);
    object.read("velocity_tolerance", settings.velocity_tolerance, kPositive);
    if (const auto iterations = object.find("max_iterations")) settings.max_iterations = iterations->integer(1);
    return settings;
}

SceneFluid read_fluid(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"name", "density", "kinematic_viscosity", "blocks", "meshes"});
    SceneFluid fluid;
    if (const auto name = object.find("name")) fluid.name = name->text();
    object.read("density", fluid.density, {Allowed::Range::positive, "kg/m^3"});
    object.read("kinematic_viscosity", fluid.kinematic_viscosity, {Allowed::Range::not_negative, "m^2/s"});
    const auto velocity_of = [&](const JsonObject& part) {
        const auto velocity = part.find("velocity");
        return velocity ? read_vector(*velocity, context, {.unit = "m/s"}) : Vec3d(Vec3d::Zero());
    };
    for (const JsonNode& entry : object.list("blocks")) {
        const JsonObject block(entry, {"min", "max", "velocity"});
        fluid.blocks.push_back({read_box(block, context), velocity_of(block)});
    }
    for (const JsonNode& entry : object.list("meshes")) {
        const JsonObject mesh(entry, {"file", "scale", "up", "position", "rotation_deg", "velocity"});
        fluid.meshes.push_back({read_mesh(mesh, context), read_pose(mesh, context), velocity_of(mesh)});
    }
    if (fluid.blocks.empty() && fluid.meshes.empty())
        node.refuse("has no fluid in it; it must have at least one entry in \"blocks\" or \"meshes\"");
    return fluid;
}

SceneFluid read_the_fluid(const JsonNode& node, const ReadContext& context)
{
    const std::vector<JsonNode> fluids = node.entries();
    if (fluids.empty()) node.refuse("has no fluid in it; it must have one entry");
    if (fluids.size() > 1)
        node.refuse("has " + std::to_string(fluids.size()) + " entries, and this version has one fluid in a scene");
    return read_fluid(fluids.front(), context);
}

SceneProbe read_probe(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"name", "pressure", "level"});
    SceneProbe probe;
    probe.name = object.required("name").text();
    if (object.exactly_one({"pressure", "level"}) == "pressure") {
        probe.point = read_vector(object.required("pressure"), context, {.unit = "m"});
        return probe;
    }
    probe.kind = SceneProbe::Kind::level;
    const JsonNode level = object.required("level");
    const std::vector<double> xy = context.dimensions == 3
                                       ? level.numbers({2}, "a list of 2 numbers [x, y]", {.unit = "m"})
                                       : level.numbers({1, 2}, "a list of 1 number [x]", {.unit = "m"});
    probe.point = Vec3d(xy[0], xy.size() > 1 ? xy[1] : 0.0, 0.0);
    if (context.dimensions == 2 && probe.point.y() != 0.0)
        level.refuse_value("must lie in the plane y = 0 in two dimensions");
    return probe;
}

/// History columns are called after bodies and probes, so their names are all different.
void refuse_columns_that_come_twice(const std::vector<std::string>& columns, const JsonObject& root)
{
    std::set<std::string> seen;
    for (const std::string& column : columns)
        if (!seen.insert(column).second)
            root.node().refuse("would have two columns \"" + column +
                               "\" in history.csv; give another name to a body or probe");
}

void add_name(std::set<std::string>& names, const std::string& name, const JsonNode& node)
{
    if (!names.insert(name).second)
        node.child("name").refuse_value("must differ from the names of all other bodies and probes");
    if (name.find_first_of(",\"\n\r") != std::string::npos)
        node.child("name").refuse_value("must be free of commas, quotes and line breaks");
}

void refuse_joints(const JsonObject& root)
{
    if (!root.list("joints").empty())
        root.required("joints").refuse("are not in this version yet; the list must be empty");
}

void read_time(const JsonObject& root, SceneFile& scene)
{
    scene.duration = root.required("duration").number({Allowed::Range::positive, "s"});
    const auto node = root.find("time_step");
    if (!node) return;
    const JsonObject time_step(*node, {"max", "cfl"});
    time_step.read("max", scene.max_time_step, {Allowed::Range::positive, "s"});
    time_step.read("cfl", scene.cfl, kPositive);
    if (!(scene.cfl <= 1.0)) time_step.required("cfl").refuse_value("must be a number in (0, 1]");
    if (!(scene.max_time_step * kMostSteps >= scene.duration))
        time_step.required("max").refuse_value("must be at least a billionth of the duration");
}

void refuse_too_many_frames(const JsonObject& root, const SceneFile& scene)
{
    if (scene.duration * scene.output.frames_per_second <= kMostFrames) return;
    root.required("duration")
        .refuse_value("must have at most a million frames, of " +
                      std::to_string(std::llround(std::min(scene.output.frames_per_second, 1e15))) +
                      " output.frames_per_second");
}

SceneFile read_root(const Json& document, const std::filesystem::path& file)
{
    const JsonObject root(JsonNode(document, file.string(), ""),
                          {"flotsam", "dimensions", "particle_spacing", "gravity", "duration", "time_step", "pressure",
                           "fluids", "walls", "bodies", "joints", "probes", "output"});
    read_version(root);
    SceneFile scene;
    scene.file = file;
    if (const auto node = root.find("dimensions")) {
        scene.dimensions = node->integer(2);
        if (scene.dimensions > 3) node->refuse_value("must be 2 or 3");
    }
    const ReadContext context{scene.dimensions, file.parent_path()};
    scene.particle_spacing = root.required("particle_spacing").number({Allowed::Range::positive, "m"});
    if (const auto node = root.find("gravity")) scene.gravity = read_vector(*node, context, {.unit = "m/s^2"});
    read_time(root, scene);
    if (const auto node = root.find("pressure")) scene.pressure = read_pressure(*node);
    scene.fluid = read_the_fluid(root.required("fluids"), context);
    for (const JsonNode& node : root.list("walls")) scene.walls.push_back(read_wall(node, context));
    std::set<std::string> names;
    for (const JsonNode& node : root.list("bodies")) {
        scene.bodies.push_back(read_body(node, context));
        add_name(names, scene.bodies.back().name, node);
    }
    refuse_joints(root);
    for (const JsonNode& node : root.list("probes")) {
        scene.probes.push_back(read_probe(node, context));
        add_name(names, scene.probes.back().name, node);
    }
    refuse_columns_that_come_twice(history_columns(scene), root);
    if (const auto node = root.find("output")) scene.output = read_output(*node, context);
    refuse_too_many_frames(root, scene);
    return scene;
}

} // namespace
} // namespace scene

SceneFile parse_scene(std::string_view text, const std::filesystem::path& file,
                      const std::vector<std::string>& overrides)
{
    scene::Json document = scene::parse_strictly(text, file.string());
    for (const std::string& each : overrides) scene::apply_override(document, each, file.string());
    return scene::read_root(document, file);
}

SceneFile read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides)
{
    std::error_code error;
    if (!std::filesystem::exists(file, error)) throw InputError(file.string() + ": there is no such scene file");
    if (std::filesystem::is_directory(file, error))
        throw InputError(file.string() + ": is a directory, and must be a scene file");
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw InputError(file.string() + ": the scene file cannot be read");
    return parse_scene(text.str(), file, overrides);
}

} // namespace flotsam
