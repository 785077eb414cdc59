#include "cli/summary.hpp"

#include "cli/table.hpp"

#include <iomanip>
#include <ostream>
#include <string>
#include <vector>

namespace flotsam::cli {
namespace {

Row draft_row(const BodyReport& body, const RunReport& report)
{
    const auto length = [](const std::optional<double>& value) { return value ? fixed(*value, 4) : std::string("-"); };
    Row row{body.name, body.mass ? fixed(*body.mass / body.volume / report.rest_density, 3) : "-",
            fixed(body.tilt_deg, 1), length(body.draft)};
    if (body.mass && body.draft && !body.exact_draft) {
        row.insert(row.end(), {"sinks", "-", "-"});
        return row;
    }
    row.push_back(length(body.exact_draft));
    if (!body.draft || !body.exact_draft) {
        row.insert(row.end(), {"-", "-"});
        return row;
    }
    const double error = *body.draft - *body.exact_draft;
    row.push_back(with_sign(100.0 * error / *body.exact_draft, 1));
    row.push_back(with_sign(error / report.particle_spacing, 2));
    return row;
}

void print_drafts(std::ostream& out, const RunReport& report)
{
    std::vector<Row> rows{
        {"body", "density ratio", "tilt [deg]", "draft [m]", "exact [m]", "error [%]", "error [spacings]"}};
    for (const BodyReport& body : report.bodies) rows.push_back(draft_row(body, report));
    out << "\nDrafts, mean over the last quarter:\n";
    print_table(out, rows);
}

void print_probes(std::ostream& out, const RunReport& report)
{
    std::vector<Row> rows{{"probe", "mean", "last"}};
    for (const ProbeReport& probe : report.probes)
        rows.push_back(
            {probe.name, probe.mean ? fixed(*probe.mean, 4) : "-", probe.last ? fixed(*probe.last, 4) : "-"});
    out << "\nProbes:\n";
    print_table(out, rows);
}

void print_files(std::ostream& out, const std::filesystem::path& directory)
{
    namespace fs = std::filesystem;
    out << "\nIn " << directory.string() << ":\n";
    std::vector<Row> rows{{"report.json", "all of this in numbers"},
                          {"history.csv", "bodies, joints and probes, frame by frame"}};
    if (fs::exists(directory / "particles.pvd")) rows.push_back({"particles.pvd", "for ParaView"});
    if (fs::exists(directory / "bodies.pvd")) rows.push_back({"bodies.pvd", "for ParaView"});
    if (fs::exists(directory / "pictures")) {
        const auto count = std::distance(fs::directory_iterator(directory / "pictures"), fs::directory_iterator());
        rows.push_back({"pictures/", std::to_string(count) + " pictures"});
    }
    for (const Row& row : rows) out << "  " << std::left << std::setw(14) << row[0] << "  " << row[1] << "\n";
}

} // namespace

void print_summary(std::ostream& out, const RunReport& report, const std::filesystem::path& directory)
{
    out << "\n"
        << fixed(report.simulated_seconds, 2) << " s simulated in " << fixed(report.wall_seconds, 1) << " s, "
        << report.steps << " steps on " << report.threads << " threads, " << fixed(report.iterations.mean, 1)
        << " iterations a step\n";
    out << "compression mean " << fixed(100.0 * report.compression.mean, 3) << " %, largest "
        << fixed(100.0 * report.compression.max, 2) << " %; " << report.unconverged_steps << " steps not converged; "
        << report.leaked << " particles leaked; " << fixed(static_cast<double>(report.peak_memory_bytes) / 1e6, 0)
        << " MB of memory\n";
    if (!report.bodies.empty()) print_drafts(out, report);
    if (!report.probes.empty()) print_probes(out, report);
    print_files(out, directory);
}

void print_check(std::ostream& out, const SceneCheck& check, const std::filesystem::path& scene)
{
    for (const std::string& note : check.notes) out << "note: " << note << "\n";
    out << scene.string() << ": nothing wrong; about " << fixed(check.fluid_particles, 0) << " fluid particles, "
        << fixed(check.boundary_samples, 0) << " boundary samples, " << fixed(check.memory_bytes / 1e6, 0)
        << " MB of memory\n";
    if (check.bodies.empty()) return;
    std::vector<Row> rows{{"body", "volume [m^3]", "mass [kg]", "density ratio"}};
    for (const SceneCheck::Body& body : check.bodies)
        rows.push_back({body.name, fixed(body.volume, 6), body.mass > 0.0 ? fixed(body.mass, 4) : "-",
                        body.mass > 0.0 ? fixed(body.density_ratio, 3) : "-"});
    out << "\n";
    print_table(out, rows);
}

void print_check(std::ostream& out, const MeshFileCheck& check, const std::filesystem::path& mesh)
{
    for (const std::string& note : check.notes) out << "note: " << note << "\n";
    const Vec3d size = check.bounds.size(), &center = check.center_of_mass;
    out << mesh.string() << ": nothing wrong; in metres: " << check.triangles << " triangles in " << check.parts
        << (check.parts == 1 ? " part" : " parts") << ", " << size.x() << " x " << size.y() << " x " << size.z()
        << " m, volume " << check.volume << " m^3, centre of mass [" << center.x() << ", " << center.y() << ", "
        << center.z() << "]\n";
}

} // namespace flotsam::cli
