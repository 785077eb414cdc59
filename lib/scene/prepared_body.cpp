#include "scene/mesh_loader.hpp"
#include "scene/probe_points.hpp"
#include "scene/refuse.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace flotsam::scene {
namespace {

Shape loaded(const SceneShapePart& part, const std::string& place, const MeshLoader& loader)
{
    return std::visit(
        [&](const auto& shape) -> Shape {
            if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, SceneMesh>)
                return MeshShape{loader.solid(shape, place + ".mesh")};
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
void refuse_overlapping_parts(const SceneFile& scene, const std::vector<TriangleMesh>& parts, const std::string& body)
{
    if (parts.size() < 2) return;
    const double tolerance = 0.25 * scene.particle_spacing;
    std::vector<SurfaceQuery> solids;
    std::vector<std::vector<Vec3d>> points;
    for (const TriangleMesh& part : parts) {
        solids.emplace_back(part);
        points.push_back(surface_points(part, scene.particle_spacing));
        const std::vector<Vec3d> inner = inner_points(solids.back(), tolerance);
        points.back().insert(points.back().end(), inner.begin(), inner.end());
    }
    for (std::size_t a = 0; a < parts.size(); ++a)
        for (std::size_t b = 0; b < parts.size(); ++b) {
            if (a == b) continue;
            for (const Vec3d& point : points[b])
                if (solids[a].bounds().contains(point) && solids[a].signed_distance(point) < -tolerance)
                    refuse(scene, body, ": parts ", a, " and ", b, " of its compound overlap; they may only touch");
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
void refuse_outer_center(const SceneFile& scene, const Vec3d& center, const TriangleMesh& mesh, const std::string& name)
{
    const Aabb box = bounds(mesh);
    const double tolerance = 1e-6 * box.size().maxCoeff();
    const bool within =
        (center.array() >= box.min.array() - tolerance).all() && (center.array() <= box.max.array() + tolerance).all();
    if (within) return;
    const Eigen::IOFormat list(4, Eigen::DontAlignCols, ", ", ", ", "", "", "[", "]");
    refuse(scene, name, " has its center_of_mass at ", center.format(list),
           " in the frame of its shape, outside of the "
           "shape, which reaches from ",
           box.min.format(list), " to ", box.max.format(list));
}

/// Samples of a solid without thickness hold no water back, and no sheet of any use is so thin.
void refuse_thin(const SceneFile& scene, const TriangleMesh& part, const std::string& name)
{
    constexpr double kThinnest = 1e-3; // [spacings]
    Vec3d extent = bounds(part).size();
    if (scene.dimensions == 2) extent.y() = extent.x();
    if (!(extent.minCoeff() >= kThinnest * scene.particle_spacing))
        refuse(scene, name, " is ", extent.minCoeff(),
               " m thin, and must be at least a thousandth of the particle "
               "spacing (",
               kThinnest * scene.particle_spacing, " m)");
}

void refuse_small(const SceneFile& scene, const TriangleMesh& mesh, const std::string& name)
{
    Vec3d extent = bounds(mesh).size();
    if (scene.dimensions == 2) extent.y() = 0.0;
    if (!(extent.maxCoeff() >= 2.0 * scene.particle_spacing))
        refuse(scene, name, " is ", extent.maxCoeff(), " m long, and must be at least 2 particle spacings (",
               2.0 * scene.particle_spacing, " m)");
}

/// Beyond these a body is thrown out of the world by the rounding of the water's forces.
void refuse_bad_mass(const SceneFile& scene, const SceneBody& body, const PreparedBody& made)
{
    constexpr double kLightest = 1e-6, kHeaviest = 1e9; // of the water's density
    constexpr double kLeastInertia = 1e-6;              // of mass x size^2
    if (!(made.mass > 0.0)) return;
    const double ratio = made.mass / made.volume / scene.fluid.density;
    if (!(ratio >= kLightest && ratio <= kHeaviest))
        refuse(scene, made.name, " has ", ratio, " times the density of the fluid, and from ", kLightest, " to ",
               kHeaviest, " times are allowed");
    const double size = bounds(made.mesh).size().maxCoeff();
    if (body.inertia && !(body.inertia->minCoeff() >= kLeastInertia * made.mass * size * size))
        refuse(scene, made.name, " has an inertia of ", body.inertia->minCoeff(), " kg m^2, and must have at least ",
               kLeastInertia * made.mass * size * size, " kg m^2, a millionth of its mass times its size squared");
}

} // namespace

PreparedBody prepare_body(const SceneFile& scene, std::size_t number, PreparedScene& prepared)
{
    const SceneBody& body = scene.bodies[number];
    const std::string place = "bodies[" + std::to_string(number) + "]";
    PreparedBody made;
    made.name = place + " (\"" + body.name + "\")";
    std::vector<TriangleMesh> meshes;
    for (const SceneShapePart& part : body.parts) {
        const std::string shape =
            place + ".shape" + (body.parts.size() > 1 ? ".compound[" + std::to_string(meshes.size()) + "]" : "");
        made.parts.push_back({loaded(part, shape, MeshLoader(scene, prepared)), part.pose});
        TriangleMesh mesh = mesh_of_part(made.parts.back().shape, scene.particle_spacing);
        refuse_thin(scene, mesh, made.name);
        meshes.push_back(transformed(std::move(mesh), part.pose));
        made.mesh = meshes.size() == 1 ? meshes.back() : joined(std::move(made.mesh), meshes.back());
    }
    refuse_small(scene, made.mesh, made.name);
    if (body.center_of_mass) refuse_outer_center(scene, *body.center_of_mass, made.mesh, made.name);
    refuse_overlapping_parts(scene, meshes, made.name);
    place_body(body, mass_properties(made.mesh), scene.dimensions, made);
    refuse_bad_mass(scene, body, made);

    const Pose to_body{made.frame.to_body(Vec3d::Zero()), made.frame.orientation.conjugate()};
    made.mesh = transformed(std::move(made.mesh), to_body);
    for (PreparedPart& part : made.parts) part.pose = to_body * part.pose;
    return made;
}

} // namespace flotsam::scene
