#include "flotsam/core/contracts.hpp"
#include "flotsam/scene/scene_file.hpp"
#include "scene/history_columns.hpp"
#include "scene/read_articulations.hpp"
#include "scene/read_joints.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

namespace flotsam {
namespace scene {
namespace {

constexpr std::size_t kLargestFile = std::size_t{16} << 20; // [bytes]

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
        settings.solver = std::array{Settings::Solver::iisph, Settings::Solver::mprgp,
                                     Settings::Solver::spg}[solver->one_of({"iisph", "mprgp", "spg"})];
    if (const auto source = object.find("source"))
        settings.source =
            std::array{Settings::Source::split, Settings::Source::published}[source->one_of({"split", "published"})];
    if (const auto coupling = object.find("coupling"))
        settings.coupling =
            std::array{Settings::Coupling::strong, Settings::Coupling::weak}[coupling->one_of({"strong", "weak"})];
    constexpr Allowed kTolerance{Allowed::Range::positive, "", 1e-12, 0.5}; // more is no equation any more
    object.read("tolerance", settings.tolerance, kTolerance);
    object.read("velocity_tolerance", settings.velocity_tolerance, kTolerance);
    if (const auto iterations = object.find("max_iterations"))
        settings.max_iterations = iterations->integer(1, 1000000);
    return settings;
}

SceneFluid read_fluid(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"name", "density", "kinematic_viscosity", "blocks", "meshes"});
    SceneFluid fluid;
    if (const auto name = object.find("name")) fluid.name = name->text();
    object.read("density", fluid.density, {Allowed::Range::positive, "kg/m^3", 1e-3, 1e6});
    object.read("kinematic_viscosity", fluid.kinematic_viscosity,
                {.range = Allowed::Range::not_negative, .unit = "m^2/s", .most = 1e3});
    const auto velocity_of = [&](const JsonObject& part) {
        const auto velocity = part.find("velocity");
        return velocity ? read_vector(*velocity, context, kSpeed) : Vec3d(Vec3d::Zero());
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

FluidWorldSettings::Start read_start(const JsonNode& node, const SceneFluid& fluid)
{
    using Start = FluidWorldSettings::Start;
    const Start start = std::array{Start::as_given, Start::at_rest}[node.one_of({"as_given", "at_rest"})];
    const auto flows = [](const auto& part) { return !part.velocity.isZero(0.0); };
    if (start == Start::at_rest && (std::any_of(fluid.blocks.begin(), fluid.blocks.end(), flows) ||
                                    std::any_of(fluid.meshes.begin(), fluid.meshes.end(), flows)))
        node.refuse_value("must be \"as_given\" for fluid with a velocity");
    return start;
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

/// History columns are called after bodies, joints and probes, so their names are all different.
void refuse_columns_that_come_twice(const std::vector<std::string>& columns, const JsonObject& root)
{
    std::set<std::string> seen;
    for (const std::string& column : columns)
        if (!seen.insert(column).second)
            root.node().refuse("would have two columns \"" + column +
                               "\" in history.csv; give another name to a body, joint or probe");
}

void read_time(const JsonObject& root, SceneFile& scene)
{
    const JsonNode duration = root.required("duration");
    scene.duration = duration.number({Allowed::Range::positive, "s"});
    std::optional<JsonNode> max;
    if (const auto node = root.find("time_step")) {
        const JsonObject time_step(*node, {"max", "cfl"});
        time_step.read("max", scene.max_time_step, {.range = Allowed::Range::positive, .unit = "s", .most = 1000.0});
        time_step.read("cfl", scene.cfl, {Allowed::Range::positive, "", 1e-3, 1.0}); // less would take months a second
        max = time_step.find("max");
    }
    if (scene.max_time_step * kMostSteps >= scene.duration) return;
    if (max) max->refuse_value("must be at least a billionth of the duration");
    duration.refuse_value("must be at most a billion times time_step.max");
}

void refuse_too_many_frames(const JsonObject& root, const SceneFile& scene)
{
    const double frames = scene.duration * scene.output.frames_per_second;
    if (frames <= kMostFrames) return;
    std::ostringstream sentence;
    sentence << "would have " << frames << " frames (duration times output.frames_per_second), "
             << "and at most a million frames are allowed";
    root.node().refuse(sentence.str());
}

SceneFile read_root(const Json& document, const std::filesystem::path& file)
{
    const JsonObject root(JsonNode(document, file.string(), ""),
                          {"flotsam", "dimensions", "particle_spacing", "gravity", "duration", "time_step", "kernel",
                           "pressure", "start", "fluids", "walls", "bodies", "joints", "articulations", "probes",
                           "output"});
    read_version(root);
    SceneFile scene;
    scene.file = file;
    if (const auto node = root.find("dimensions")) {
        if (node->json() != 2 && node->json() != 3) node->refuse_value("must be 2 or 3");
        scene.dimensions = node->integer(2, 3);
    }
    const ReadContext context{scene.dimensions, file.parent_path()};
    scene.particle_spacing = root.required("particle_spacing").number({Allowed::Range::positive, "m"});
    if (const auto node = root.find("gravity"))
        scene.gravity = read_vector(*node, context, {.unit = "m/s^2", .most = 1e4});
    read_time(root, scene);
    if (const auto node = root.find("kernel"))
        scene.kernel = std::array{KernelKind::quintic, KernelKind::cubic}[node->one_of({"quintic", "cubic"})];
    if (const auto node = root.find("pressure")) scene.pressure = read_pressure(*node);
    scene.fluid = read_the_fluid(root.required("fluids"), context);
    if (const auto node = root.find("start")) scene.start = read_start(*node, scene.fluid);
    for (const JsonNode& node : root.list("walls")) scene.walls.push_back(read_wall(node, context));
    std::set<std::string> names;
    for (const JsonNode& node : root.list("bodies")) {
        scene.bodies.push_back(read_body(node, context));
        add_name(names, scene.bodies.back().name, node);
    }
    scene.joints = read_joints(root, context, scene.bodies, names);
    scene.articulations = read_articulations(root, scene);
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
    if (file.empty()) throw InputError("the scene file has an empty name");
    std::error_code error;
    if (!std::filesystem::exists(file, error)) throw InputError(file.string() + ": there is no such scene file");
    if (std::filesystem::is_directory(file, error))
        throw InputError(file.string() + ": is a directory, and must be a scene file");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file.string() + ": the scene file cannot be read");
    std::string text(scene::kLargestFile + 1, '\0'); // a device may have no end
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (stream.bad()) throw InputError(file.string() + ": the scene file cannot be read");
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > scene::kLargestFile)
        throw InputError(file.string() + ": is larger than 16 MB, which no scene file is");
    return parse_scene(text, file, overrides);
}

} // namespace flotsam
