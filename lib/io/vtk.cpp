#include "flotsam/io/vtk.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_directory.hpp"
#include "io/markup_text.hpp"
#include "io/vtp_file.hpp"

#include <charconv>
#include <cmath>
#include <numeric>

namespace flotsam {

namespace {

std::vector<float> xyz(const std::vector<Vec4>& vectors)
{
    std::vector<float> result;
    result.reserve(3 * vectors.size());
    for (const Vec4& v : vectors) result.insert(result.end(), {v.x(), v.y(), v.z()});
    return result;
}

std::vector<std::int32_t> counted(std::size_t count, std::int32_t first, std::int32_t stride = 1)
{
    std::vector<std::int32_t> result(count);
    for (std::size_t k = 0; k < count; ++k) result[k] = first + stride * static_cast<std::int32_t>(k);
    return result;
}

/// One vertex cell per point and not one for all: ParaView's Threshold and Clip work by cells.
struct VertexCloud {
    std::vector<float> positions;
    std::vector<std::int32_t> connectivity, offsets;

    explicit VertexCloud(const std::vector<Vec4>& points)
        : positions(xyz(points)), connectivity(counted(points.size(), 0)), offsets(counted(points.size(), 1))
    {
    }
    [[nodiscard]] VtpFile file() const
    {
        VtpFile f;
        f.points = f.cells = connectivity.size();
        f.positions = vtp_array("Points", positions, 3);
        f.connectivity = vtp_array("connectivity", connectivity);
        f.offsets = vtp_array("offsets", offsets);
        return f;
    }
};

std::string shortest(double value)
{
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

} // namespace

void write_particles_vtp(const std::filesystem::path& file, const FluidState& fluid)
{
    const VertexCloud cloud(fluid.position);
    const std::vector<float> velocity = xyz(fluid.velocity);
    std::vector<float> speed(fluid.size());
    for (std::size_t i = 0; i < fluid.size(); ++i) speed[i] = fluid.velocity[i].head<3>().norm();

    VtpFile vtp = cloud.file();
    vtp.point_scalars = "speed";
    vtp.point_vectors = "velocity";
    vtp.point_data = {vtp_array("velocity", velocity, 3), vtp_array("speed", speed),
                      vtp_array("density", fluid.density), vtp_array("pressure", fluid.pressure),
                      vtp_array("id", fluid.id)};
    vtp.write(file);
}

void write_bodies_vtp(const std::filesystem::path& file, std::span<const PlacedMesh> bodies)
{
    std::vector<double> positions;
    std::vector<std::int32_t> connectivity, body_of_triangle;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        require(bodies[k].mesh != nullptr, "every body must have a mesh");
        const auto first = static_cast<std::int32_t>(positions.size() / 3);
        for (const Vec3d& vertex : bodies[k].mesh->vertices) {
            const Vec3d point = bodies[k].pose.to_world(vertex);
            positions.insert(positions.end(), {point.x(), point.y(), point.z()});
        }
        for (const auto& [a, b, c] : bodies[k].mesh->triangles) {
            connectivity.insert(connectivity.end(), {first + a, first + b, first + c});
        }
        body_of_triangle.resize(connectivity.size() / 3, static_cast<std::int32_t>(k));
    }
    const std::vector<std::int32_t> offsets = counted(body_of_triangle.size(), 3, 3);

    VtpFile vtp;
    vtp.kind = VtpFile::Cells::polygons;
    vtp.points = positions.size() / 3;
    vtp.cells = body_of_triangle.size();
    vtp.positions = vtp_array("Points", positions, 3);
    vtp.connectivity = vtp_array("connectivity", connectivity);
    vtp.offsets = vtp_array("offsets", offsets);
    vtp.cell_data = {vtp_array("body", body_of_triangle)};
    vtp.write(file);
}

void write_boundary_vtp(const std::filesystem::path& file, const BoundaryState& boundary)
{
    const VertexCloud cloud(boundary.position);
    const std::vector<float> velocity = xyz(boundary.velocity);
    std::vector<float> volume(boundary.size());
    for (std::size_t b = 0; b < boundary.size(); ++b) volume[b] = boundary.position[b].w();

    VtpFile vtp = cloud.file();
    vtp.point_scalars = "owner";
    vtp.point_vectors = "velocity";
    vtp.point_data = {vtp_array("velocity", velocity, 3), vtp_array("volume", volume),
                      vtp_array("owner", boundary.owner)};
    vtp.write(file);
}

void PvdSeries::add(double time, const std::filesystem::path& frame)
{
    require(std::isfinite(time), "the time of a frame must be finite [s]", time);
    entries_.push_back("<DataSet timestep=\"" + shortest(time) + "\" group=\"\" part=\"0\" file=\"" +
                       escaped(frame.generic_string()) + "\"/>\n");
    const std::string start = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    write_text_atomically(file_,
                          std::accumulate(entries_.begin(), entries_.end(), start) + "</Collection>\n</VTKFile>\n");
}

} // namespace flotsam
