#include "scene/read_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flotsam::scene {
namespace {

constexpr int kMostPixels = 8192; ///< wide or high; such a picture takes half a minute

Quatd rotation_from_degrees(const Vec3d& degrees)
{
    const double angle = degrees.norm();
    const double turned = std::remainder(angle, 360.0) * (std::numbers::pi / 180.0); // exact, also of many turns
    return angle > 0.0 ? Quatd(Eigen::AngleAxisd(turned, degrees / angle)) : Quatd::Identity();
}

Vec3d read_rotation(const JsonNode& node, const ReadContext& context, Allowed allowed)
{
    const std::vector<double> v = node.numbers({3}, "a list of 3 numbers", allowed);
    if (context.dimensions == 2 && (v[0] != 0.0 || v[2] != 0.0))
        node.refuse_value("must be [0, angle, 0] in two dimensions, where all turning is about y");
    return {v[0], v[1], v[2]};
}

/// Of shapes: what is shorter has no area in double precision.
constexpr Allowed kLength{Allowed::Range::positive, "m", 1e-9};

Vec3d read_sizes(const JsonNode& node, const ReadContext& context)
{
    if (context.dimensions == 2) {
        const std::vector<double> xz = node.numbers({2}, "the 2 edge lengths [x, z]", kLength);
        return {xz[0], 1.0, xz[1]};
    }
    const std::vector<double> v = node.numbers({3}, "the 3 edge lengths [x, y, z]", kLength);
    return {v[0], v[1], v[2]};
}

SceneShapePart read_simple_shape(const JsonObject& object, const std::string& kind, const ReadContext& context)
{
    const JsonNode node = object.required(kind.c_str());
    const bool plane = kind == "disc";
    if (kind != "box" && plane != (context.dimensions == 2))
        node.refuse(plane ? "is a shape for two dimensions; in three there are box, sphere, cylinder, mesh and compound"
                          : "is a shape for three dimensions; in two there are box, disc and compound");
    if (kind == "box") return {BoxShape{read_sizes(node, context)}, {}};
    if (kind == "sphere") return {SphereShape{node.number(kLength)}, {}};
    if (kind == "disc") return {DiscShape{node.number(kLength)}, {}};
    if (kind == "cylinder") {
        const std::vector<double> sizes = node.numbers({2}, "the 2 lengths [radius, height]", kLength);
        return {CylinderShape{sizes[0], sizes[1]}, {}};
    }
    return {read_mesh(JsonObject(node, {"file", "scale", "up"}), context), {}};
}

std::vector<SceneShapePart> read_shape(const JsonNode& node, const ReadContext& context)
{
    const JsonObject shape(node, {"box", "sphere", "cylinder", "disc", "mesh", "compound"});
    const std::string kind = shape.exactly_one({"box", "sphere", "cylinder", "disc", "mesh", "compound"});
    if (kind != "compound") return {read_simple_shape(shape, kind, context)};
    std::vector<SceneShapePart> parts;
    for (const JsonNode& entry : shape.list("compound")) {
        const JsonObject part(entry, {"box", "sphere", "cylinder", "disc", "mesh", "position", "rotation_deg"});
        parts.push_back(
            read_simple_shape(part, part.exactly_one({"box", "sphere", "cylinder", "disc", "mesh"}), context));
        parts.back().pose = read_pose(part, context);
    }
    if (parts.empty()) shape.required("compound").refuse("must have at least one part");
    return parts;
}

std::array<bool, 6> read_lock(const JsonObject& body)
{
    std::array<bool, 6> lock{};
    for (const JsonNode& entry : body.list("lock")) lock[entry.one_of({"x", "y", "z", "rx", "ry", "rz"})] = true;
    return lock;
}

void read_mass(const JsonObject& object, SceneBody& body)
{
    if (object.has("density") && object.has("mass"))
        object.node().refuse("has both \"density\" and \"mass\", and only one of them is allowed");
    if (const auto node = object.find("density")) body.density = node->number({Allowed::Range::positive, "kg/m^3"});
    if (const auto node = object.find("mass")) body.mass = node->number({Allowed::Range::positive, "kg"});
    if (body.motion == SceneBody::Motion::dynamic && !body.density && !body.mass)
        object.node().refuse("is dynamic and must have \"density\" or \"mass\"");
}

/// The inertia of any solid has each principal moment no larger than the sum of the other two.
Vec3d read_inertia(const JsonNode& node)
{
    const std::vector<double> v = node.numbers({3}, "the 3 moments [xx, yy, zz]", {Allowed::Range::positive, "kg m^2"});
    const double largest = *std::max_element(v.begin(), v.end());
    if (!(2.0 * largest <= (v[0] + v[1] + v[2]) * (1.0 + 1e-9)))
        node.refuse_value("must be moments of a solid, none larger than the sum of the other two");
    return {v[0], v[1], v[2]};
}

/// A lock holds an axis still and says nothing of bodies that are not dynamic.
void refuse_idle_locks(const JsonObject& object, const SceneBody& body)
{
    for (std::size_t k = 0; k < 6; ++k) {
        if (!body.lock[k]) continue;
        const JsonNode lock = object.required("lock");
        if (body.motion != SceneBody::Motion::dynamic) lock.refuse("is for dynamic bodies only");
        const auto axis = static_cast<Eigen::Index>(k % 3);
        if ((k < 3 ? body.velocity : body.angular_velocity)[axis] != 0.0)
            lock.refuse("holds an axis along which the body is given a velocity");
    }
}

void read_motion(const JsonObject& object, const ReadContext& context, SceneBody& body)
{
    using Motion = SceneBody::Motion;
    if (const auto node = object.find("motion"))
        body.motion =
            std::array{Motion::dynamic, Motion::fixed, Motion::moving}[node->one_of({"dynamic", "fixed", "moving"})];
    if (const auto node = object.find("velocity")) body.velocity = read_vector(*node, context, kSpeed);
    if (const auto node = object.find("angular_velocity"))
        body.angular_velocity = read_rotation(*node, context, {.unit = "rad/s", .most = 1e4});
    if (body.motion == Motion::fixed && !(body.velocity.isZero(0.0) && body.angular_velocity.isZero(0.0)))
        object.node().refuse("is fixed and has a velocity; \"motion\": \"moving\" moves at a given velocity");
    if (body.motion == Motion::moving && !object.has("velocity") && !object.has("angular_velocity"))
        object.node().refuse("is moving and must have \"velocity\" or \"angular_velocity\"");
    body.lock = read_lock(object);
    refuse_idle_locks(object, body);
}

WallSide read_side(const JsonObject& mesh)
{
    const auto node = mesh.find("side");
    if (!node) return WallSide::automatic;
    return std::array{WallSide::automatic, WallSide::inside, WallSide::outside,
                      WallSide::both}[node->one_of({"auto", "inside", "outside", "both"})];
}

SceneCamera read_camera(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"position", "look_at", "fov_deg"});
    const ReadContext space{3, context.folder}; // a camera looks at the plane of a 2-D scene from outside of it
    SceneCamera camera;
    camera.position = read_vector(object.required("position"), space, {.unit = "m"});
    camera.look_at = read_vector(object.required("look_at"), space, {.unit = "m"});
    if (!((camera.position - camera.look_at).norm() > 1e-6)) // [m]
        node.refuse("must have position and look_at apart from each other");
    object.read("fov_deg", camera.fov_deg, {Allowed::Range::positive, "degrees"});
    if (!(camera.fov_deg < 170.0)) object.required("fov_deg").refuse_value("must be a number below 170 [degrees]");
    return camera;
}

std::optional<ScenePictures> read_pictures(const JsonNode& node, const ReadContext& context)
{
    if (node.json().is_boolean()) return node.boolean() ? std::optional(ScenePictures()) : std::nullopt;
    const JsonObject object(node, {"width", "height", "every", "camera"});
    ScenePictures pictures;
    if (const auto width = object.find("width")) pictures.width = width->integer(16, kMostPixels);
    if (const auto height = object.find("height")) pictures.height = height->integer(16, kMostPixels);
    if (const auto every = object.find("every")) pictures.every = every->integer(1, 1000000);
    if (const auto camera = object.find("camera")) pictures.camera = read_camera(*camera, context);
    return pictures;
}

} // namespace

void add_name(std::set<std::string>& names, const std::string& name, const JsonNode& node)
{
    if (!names.insert(name).second)
        node.child("name").refuse_value("must differ from the names of all other bodies, joints and probes");
    const auto breaks_a_table = [](unsigned char c) { return c == ',' || c == '"' || c < 0x20 || c == 0x7f; };
    if (std::any_of(name.begin(), name.end(), breaks_a_table))
        node.child("name").refuse_value("must be free of commas, quotes, tabs, line breaks and the like");
    if (name.find_first_not_of(' ') == std::string::npos || name.front() == ' ' || name.back() == ' ')
        node.child("name").refuse_value("must not begin or end with a space");
}

Vec3d read_vector(const JsonNode& node, const ReadContext& context, Allowed allowed)
{
    if (context.dimensions == 3) {
        const std::vector<double> v = node.numbers({3}, "a list of 3 numbers [x, y, z]", allowed);
        return {v[0], v[1], v[2]};
    }
    const std::vector<double> v = node.numbers({2, 3}, "a list of 2 numbers [x, z]", allowed);
    if (v.size() == 2) return {v[0], 0.0, v[1]};
    if (v[1] != 0.0) node.refuse_value("must lie in the plane y = 0 in two dimensions");
    return {v[0], 0.0, v[2]};
}

Aabb read_box(const JsonObject& object, const ReadContext& context)
{
    Aabb box{read_vector(object.required("min"), context, {.unit = "m"}),
             read_vector(object.required("max"), context, {.unit = "m"})};
    if (context.dimensions == 2) {
        box.min.y() = -0.5;
        box.max.y() = 0.5;
    }
    if (!(box.min.array() < box.max.array()).all())
        object.node().refuse_value("must have every coordinate of \"max\" above that of \"min\"");
    return box;
}

Pose read_pose(const JsonObject& object, const ReadContext& context)
{
    Pose pose;
    if (const auto node = object.find("position")) pose.position = read_vector(*node, context, {.unit = "m"});
    if (const auto node = object.find("rotation_deg"))
        pose.orientation = rotation_from_degrees(read_rotation(*node, context, {.unit = "degrees"}));
    return pose;
}

SceneMesh read_mesh(const JsonObject& object, const ReadContext& context)
{
    using Up = MeshFileOptions::UpAxis;
    SceneMesh mesh;
    mesh.file = (context.folder / object.required("file").text()).lexically_normal();
    object.read("scale", mesh.options.scale, {Allowed::Range::positive, "m per unit of the file"});
    if (const auto node = object.find("up"))
        mesh.options.up = std::array{Up::z, Up::y, Up::x}[node->one_of({"z", "y", "x"})];
    return mesh;
}

SceneBody read_body(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"name", "shape", "density", "mass", "position", "rotation_deg", "velocity",
                                   "angular_velocity", "friction", "lock", "motion", "center_of_mass", "inertia"});
    SceneBody body;
    body.name = object.required("name").text();
    body.parts = read_shape(object.required("shape"), context);
    read_motion(object, context, body);
    read_mass(object, body);
    body.pose = read_pose(object, context);
    object.read("friction", body.friction, {Allowed::Range::not_negative, ""});
    if (const auto center = object.find("center_of_mass"))
        body.center_of_mass = read_vector(*center, context, {.unit = "m"});
    if (const auto inertia = object.find("inertia")) body.inertia = read_inertia(*inertia);
    return body;
}

SceneWall read_wall(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"name", "box", "mesh"});
    SceneWall wall;
    if (const auto name = object.find("name")) wall.name = name->text();
    if (object.exactly_one({"box", "mesh"}) == "mesh") {
        const JsonObject mesh(object.required("mesh"), {"file", "scale", "up", "position", "rotation_deg", "side"});
        wall.mesh = read_mesh(mesh, context);
        wall.pose = read_pose(mesh, context);
        wall.side = read_side(mesh);
        return wall;
    }
    const JsonObject box(object.required("box"), {"min", "max", "open"});
    const auto words = {"-x", "+x", "-y", "+y", "-z", "+z"};
    wall.box = read_box(box, context);
    for (const JsonNode& side : box.list("open")) wall.open.emplace_back(*(words.begin() + side.one_of(words)));
    if (context.dimensions == 2) wall.open.insert(wall.open.end(), {"-y", "+y"});
    std::sort(wall.open.begin(), wall.open.end());
    wall.open.erase(std::unique(wall.open.begin(), wall.open.end()), wall.open.end());
    if (wall.open.size() == 6) box.required("open").refuse("leaves no side closed");
    return wall;
}

SceneOutput read_output(const JsonNode& node, const ReadContext& context)
{
    const JsonObject object(node, {"frames_per_second", "vtk", "pictures"});
    SceneOutput output;
    object.read("frames_per_second", output.frames_per_second, {Allowed::Range::positive, "1/s"});
    if (const auto vtk = object.find("vtk")) output.vtk = vtk->boolean();
    if (const auto pictures = object.find("pictures")) output.pictures = read_pictures(*pictures, context);
    return output;
}

} // namespace flotsam::scene
