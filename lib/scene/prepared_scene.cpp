#include "scene/prepared_scene.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mesh_check.hpp"
#include "scene/memory_need.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flotsam::scene {
namespace {

TriangleMesh load_checked(const SceneMesh& source, bool must_be_closed, double spacing, PreparedScene& prepared,
                          bool* closed = nullptr)
{
    TriangleMesh mesh = load_mesh(source.file, source.options);
    const MeshCheckReport report =
        check_mesh(mesh, {.name = source.file.string(), .must_be_closed = must_be_closed, .particle_spacing = spacing});
    for (const std::string& note : report.notes)
        if (std::find(prepared.notes.begin(), prepared.notes.end(), note) == prepared.notes.end())
            prepared.notes.push_back(note);
    if (closed) *closed = report.closed;
    return mesh;
}

// -- fluid and walls ----------------------------------------------------------------------------------------------

/// The block within the closed sides of the box.
Aabb clipped(Aabb block, const SceneWall& wall)
{
    const auto closed = [&](const char* side) {
        return std::find(wall.open.begin(), wall.open.end(), side) == wall.open.end();
    };
    const std::array low{"-x", "-y", "-z"}, high{"+x", "+y", "+z"};
    for (int axis = 0; axis < 3; ++axis) {
        if (closed(low[static_cast<std::size_t>(axis)]))
            block.min[axis] = std::max(block.min[axis], wall.box.min[axis]);
        if (closed(high[static_cast<std::size_t>(axis)]))
            block.max[axis] = std::min(block.max[axis], wall.box.max[axis]);
    }
    return block;
}

void add_blocks(const SceneFile& scene, PreparedScene& prepared)
{
    for (std::size_t k = 0; k < scene.fluid.blocks.size(); ++k) {
        SceneBlock block = scene.fluid.blocks[k];
        for (const SceneWall& wall : scene.walls)
            if (!wall.mesh) block.box = clipped(block.box, wall);
        const std::string name = "fluids[0].blocks[" + std::to_string(k) + "]";
        if (block.box.empty() || !(block.box.size().minCoeff() > 0.0)) {
            prepared.notes.push_back(name + " lies outside the walls and was left out");
            continue;
        }
        const double left = block.box.size().prod() / scene.fluid.blocks[k].box.size().prod();
        if (left < 1.0 - 1e-9) {
            std::ostringstream note;
            note.precision(3);
            note << name << " reaches through the walls; the " << 100.0 * (1.0 - left) << " % outside were cut away";
            prepared.notes.push_back(note.str());
        }
        prepared.blocks.push_back(block);
    }
}

void add_fluid_meshes(const SceneFile& scene, PreparedScene& prepared)
{
    for (const SceneFluidMesh& fluid : scene.fluid.meshes)
        prepared.fluid_meshes.push_back(
            transformed(load_checked(fluid.mesh, true, scene.particle_spacing, prepared), fluid.pose));
}

void add_walls(const SceneFile& scene, PreparedScene& prepared)
{
    for (std::size_t k = 0; k < scene.walls.size(); ++k) {
        const SceneWall& wall = scene.walls[k];
        PreparedWall made;
        made.name = "walls[" + std::to_string(k) + "]" + (wall.name.empty() ? "" : " (\"" + wall.name + "\")");
        if (wall.mesh)
            made.mesh = transformed(load_checked(*wall.mesh, false, 0.0, prepared, &made.closed), wall.pose);
        else
            made.mesh = container_box(wall.box, wall.open);
        prepared.walls.push_back(std::move(made));
    }
}

// -- bodies -------------------------------------------------------------------------------------------------------

Shape loaded(const SceneShapePart& part, double spacing, PreparedScene& prepared)
{
    return std::visit(
        [&](const auto& shape) -> Shape {
            if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, SceneMesh>)
                return MeshShape{load_checked(shape, true, spacing, prepared)};
            else
                return shape;
        },
        part.shape);
}

/// Round shapes get edges of about a spacing; not finer than they can be told from round.
TriangleMesh mesh_of_part(const Shape& shape, double spacing)
{
    const Aabb coarse = bounds(tessellate(shape, 1e9));
    return tessellate(shape, std::max(spacing, coarse.size().maxCoeff() / 100.0));
}

/// Parts that cut each other would count twice in volume and buoyancy.
void refuse_overlapping_parts(const std::vector<TriangleMesh>& parts, const std::string& body, double tolerance)
{
    for (std::size_t a = 0; a < parts.size() && parts.size() > 1; ++a) {
        const SurfaceQuery query(parts[a]);
        const Aabb reach = query.bounds();
        for (std::size_t b = 0; b < parts.size(); ++b) {
            if (a == b) continue;
            for (const Vec3d& point : refined(parts[b], 4.0 * tolerance).vertices)
                if (reach.contains(point) && query.signed_distance(point) < -tolerance)
                    throw InputError(body + ": parts " + std::to_string(a) + " and " + std::to_string(b) +
                                     " of its compound overlap; they may only touch");
        }
    }
}

/// Moments about the axes of the body's frame, which is turned to the principal ones where it has to be. In 2-D only
/// the moment about y counts, and y must stay where it is.
Vec3d principal_moments(const Mat3d& inertia, int dimensions, Quatd& axes)
{
    const Mat3d off_diagonal = inertia - Mat3d(inertia.diagonal().asDiagonal());
    axes = Quatd::Identity();
    if (dimensions == 2 || off_diagonal.norm() <= 1e-6 * inertia.trace()) return inertia.diagonal();
    const Eigen::SelfAdjointEigenSolver<Mat3d> solver(inertia);
    Mat3d columns = solver.eigenvectors();
    if (columns.determinant() < 0.0) columns.col(0) *= -1.0;
    axes = Quatd(columns).normalized();
    return solver.eigenvalues();
}

void place_body(const SceneBody& body, const MassProperties& uniform, int dimensions, PreparedBody& made)
{
    made.volume = uniform.volume;
    made.mass = body.mass ? *body.mass : body.density.value_or(0.0) * uniform.volume;
    made.frame.position = body.center_of_mass.value_or(uniform.center_of_mass);
    if (dimensions == 2) made.frame.position.y() = 0.0;
    Mat3d inertia = uniform.inertia * (made.mass / uniform.volume);
    if (body.inertia) inertia = body.inertia->asDiagonal();
    made.inertia = principal_moments(inertia, dimensions, made.frame.orientation);
    made.start = body.pose * made.frame;
}

/// Mass lies in the body, so its centre lies between the body's ends.
void refuse_outer_center(const Vec3d& center, const TriangleMesh& mesh, const SceneFile& scene, const std::string& name)
{
    const Aabb box = bounds(mesh);
    const double tolerance = 1e-6 * box.size().maxCoeff();
    const bool within =
        (center.array() >= box.min.array() - tolerance).all() && (center.array() <= box.max.array() + tolerance).all();
    if (within) return;
    std::ostringstream sentence;
    const Eigen::IOFormat list(4, Eigen::DontAlignCols, ", ", ", ", "", "", "[", "]");
    sentence << scene.file.string() << ": " << name << " has its center_of_mass at " << center.format(list)
             << " in the frame of its shape, outside of the shape, which reaches from " << box.min.format(list)
             << " to " << box.max.format(list);
    throw InputError(sentence.str());
}

PreparedBody prepared_body(const SceneFile& scene, const SceneBody& body, PreparedScene& prepared)
{
    PreparedBody made;
    std::vector<TriangleMesh> meshes;
    for (const SceneShapePart& part : body.parts) {
        made.parts.push_back({loaded(part, scene.particle_spacing, prepared), part.pose});
        meshes.push_back(transformed(mesh_of_part(made.parts.back().shape, scene.particle_spacing), part.pose));
        made.mesh = meshes.size() == 1 ? meshes.back() : joined(std::move(made.mesh), meshes.back());
    }
    const std::string name = "body \"" + body.name + "\"";
    Vec3d extent = bounds(made.mesh).size();
    if (scene.dimensions == 2) extent.y() = 0.0;
    if (!(extent.maxCoeff() >= 2.0 * scene.particle_spacing)) {
        std::ostringstream sentence;
        sentence << scene.file.string() << ": " << name << " is " << extent.maxCoeff()
                 << " m long, and must be at least 2 particle spacings (" << 2.0 * scene.particle_spacing << " m)";
        throw InputError(sentence.str());
    }
    if (body.center_of_mass) refuse_outer_center(*body.center_of_mass, made.mesh, scene, name);
    refuse_overlapping_parts(meshes, scene.file.string() + ": " + name, 0.25 * scene.particle_spacing);
    place_body(body, mass_properties(made.mesh), scene.dimensions, made);

    const Pose to_body{made.frame.to_body(Vec3d::Zero()), made.frame.orientation.conjugate()};
    made.mesh = transformed(std::move(made.mesh), to_body);
    for (PreparedPart& part : made.parts) part.pose = to_body * part.pose;
    return made;
}

} // namespace

PreparedScene prepare_scene(const SceneFile& scene)
{
    PreparedScene prepared;
    add_blocks(scene, prepared);
    add_walls(scene, prepared);
    add_fluid_meshes(scene, prepared);
    refuse_too_many_particles(scene, prepared); // before bodies are cut into triangles as small as the particles
    for (const SceneBody& body : scene.bodies) prepared.bodies.push_back(prepared_body(scene, body, prepared));
    refuse_too_many_particles(scene, prepared);
    return prepared;
}

PreparedScene prepare_and_check(const SceneFile& scene)
{
    PreparedScene prepared = prepare_scene(scene);
    check_bodies(scene, prepared);
    check_fluid(scene, prepared);
    return prepared;
}

} // namespace flotsam::scene
