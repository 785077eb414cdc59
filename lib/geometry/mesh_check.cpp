#include "flotsam/geometry/mesh_check.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/mass_properties.hpp"
#include "geometry/mesh_connectivity.hpp"
#include "mesh_crossing.hpp"
#include "mesh_repair.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flotsam {

namespace {

constexpr double kWeldTolerance = 1e-6;              ///< of the bounds' diagonal
constexpr double kFarthest = 1e9;                    ///< [m]; beyond it, squares and cubes of lengths lose all digits
constexpr std::size_t kMostForSelfCrossing = 100000; ///< triangles; looking for it takes a fraction of a second

template <class... Words>
std::string sentence(const Words&... words)
{
    std::ostringstream text;
    (text << ... << words);
    return text.str();
}

std::string place(const Vec3d& point)
{
    return sentence("(", point.x(), ", ", point.y(), ", ", point.z(), ")");
}

std::string place(const TriangleMesh& mesh, const VertexPair& edge)
{
    return sentence("from ", place(mesh.vertices[static_cast<std::size_t>(edge[0])]), " to ",
                    place(mesh.vertices[static_cast<std::size_t>(edge[1])]));
}

std::string counted(std::size_t count, const char* one, const char* several)
{
    return sentence(count, " ", count == 1 ? one : several);
}

/// One check after the other; each may rely on those before it.
class MeshChecker {
  public:
    MeshChecker(TriangleMesh& mesh, const MeshCheckOptions& options) : mesh_(mesh), options_(options) {}

    MeshCheckReport run()
    {
        check_numbers();
        check_size();
        repair();
        const TriangleAdjacency topology = triangle_adjacency(mesh_);
        check_edges(topology);
        parts_ = connected_parts(mesh_, topology);
        if (parts_.not_orientable)
            refuse("is not orientable: at the edge ", place(mesh_, *parts_.not_orientable),
                   " its sides run into each other (as in a Moebius strip)");
        orient();
        name_parts();
        if (options_.must_be_closed) check_crossings();
        return report_;
    }

  private:
    template <class... Words>
    [[noreturn]] void refuse(const Words&... words) const
    {
        throw InputError(sentence(options_.name, " ", words...));
    }

    template <class... Words>
    void note(const Words&... words)
    {
        report_.notes.push_back(sentence(options_.name, ": ", words...));
    }

    void check_numbers() const
    {
        if (mesh_.empty()) refuse("has no triangles, at least one is needed");
        const auto vertex_count = static_cast<int>(mesh_.vertices.size());
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            for (const int v : mesh_.triangles[t])
                if (v < 0 || v >= vertex_count)
                    refuse("has no vertex ", v, ", which triangle ", t, " names; allowed are 0 to ", vertex_count - 1);
        for (int v = 0; v < vertex_count; ++v) {
            const Vec3d& vertex = mesh_.vertices[static_cast<std::size_t>(v)];
            if (!(vertex.array().abs() <= kFarthest).all())
                refuse("has vertex ", v, " at ", place(vertex), "; coordinates must be finite and within 1e9 m");
        }
    }

    void check_size()
    {
        const double spacing = options_.particle_spacing;
        drop_unused_vertices(mesh_);
        const Vec3d size = bounds(mesh_).size();
        if (!options_.must_be_closed || spacing == 0.0) return;
        if (size.maxCoeff() < 2.0 * spacing)
            refuse("measures ", size.x(), " x ", size.y(), " x ", size.z(), " m, but particles with a spacing of ",
                   spacing, " m resolve bodies of at least ", 2.0 * spacing, " m only; is it in metres?");
        if (size.minCoeff() < spacing)
            note("its smallest extent, ", size.minCoeff(), " m, is below the particle spacing of ", spacing, " m");
    }

    void repair()
    {
        tolerance_ = kWeldTolerance * bounds(mesh_).size().norm();
        const Weld weld = weld_vertices(mesh_, tolerance_);
        report_.welded_vertices = weld.merged;
        if (weld.merged_apart > 0)
            note("welded ", counted(weld.merged_apart, "vertex", "vertices"), " to others up to ", weld.farthest,
                 " m away");
        report_.dropped_triangles = drop_degenerate_triangles(mesh_);
        if (mesh_.empty()) refuse("has only triangles without area, at least one with area is needed");
        if (report_.dropped_triangles > 0)
            note("dropped ", counted(report_.dropped_triangles, "degenerate or doubled triangle",
                                     "degenerate or doubled triangles"));
        drop_unused_vertices(mesh_);
    }

    void check_edges(const TriangleAdjacency& topology) const
    {
        if (!options_.must_be_closed) return;
        const auto refuse_edges = [&](const std::vector<VertexPair>& edges, const char* fault, const char* allowed) {
            if (edges.empty()) return;
            refuse("has ", counted(edges.size(), "edge", "edges"), fault, ", the first ", place(mesh_, edges.front()),
                   "; ", allowed);
        };
        refuse_edges(topology.crowded_edges, " shared by more than two triangles",
                     "a solid's surface has two at every edge");
        refuse_edges(topology.open_edges, " with a triangle on one side only", "the surface of a solid must be closed");
    }

    void flip(std::size_t triangle)
    {
        std::swap(mesh_.triangles[triangle][1], mesh_.triangles[triangle][2]);
        parts_.is_flipped[triangle] = static_cast<char>(!parts_.is_flipped[triangle]);
    }

    void flip_part(std::size_t part)
    {
        for (const int t : parts_.triangles[part]) flip(static_cast<std::size_t>(t));
    }

    void orient()
    {
        std::vector<Aabb> boxes;
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            if (parts_.is_flipped[t] != 0) std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
        for (std::size_t part = 0; part < parts_.triangles.size(); ++part) {
            const TriangleMesh alone = with_triangles(mesh_, parts_.triangles[part]);
            boxes.push_back(bounds(alone));
            if (parts_.is_closed[part] != 0)
                orient_closed(part, alone);
            else
                orient_open(part);
        }
        const std::vector<std::size_t> cavities = find_cavities(boxes);
        for (const std::size_t cavity : cavities) flip_part(cavity);
        report_.flipped_triangles = static_cast<int>(
            std::count_if(parts_.is_flipped.begin(), parts_.is_flipped.end(), [](char f) { return f; }));
        report_.closed = std::all_of(parts_.is_closed.begin(), parts_.is_closed.end(), [](char c) { return c; });
        const char* wrong = report_.closed ? (cavities.empty() ? "inward" : "the wrong way") : "against the others";
        if (report_.flipped_triangles > 0)
            note("turned ", report_.flipped_triangles, " of ", mesh_.triangles.size(), " triangles that faced ", wrong);
        if (!cavities.empty())
            note(counted(cavities.size(), "part lies", "parts lie"), " inside another part and is taken for a cavity");
    }

    void orient_closed(std::size_t part, const TriangleMesh& alone)
    {
        double area = 0.0;
        for (std::size_t t = 0; t < alone.triangles.size(); ++t)
            area +=
                0.5 * (alone.corner(t, 1) - alone.corner(t, 0)).cross(alone.corner(t, 2) - alone.corner(t, 0)).norm();
        const double volume = mass_properties(alone).volume;
        if (options_.must_be_closed && !(std::abs(volume) > area * tolerance_))
            refuse("encloses no volume at ", place(bounds(alone).center()), "; a solid needs a volume above zero");
        if (volume < 0.0) flip_part(part);
    }

    /// Nothing says which side of a sheet is right: as most of its triangles had it.
    void orient_open(std::size_t part)
    {
        const std::vector<int>& triangles = parts_.triangles[part];
        const auto flipped = std::count_if(triangles.begin(), triangles.end(),
                                           [&](int t) { return parts_.is_flipped[static_cast<std::size_t>(t)] != 0; });
        if (2 * flipped > static_cast<std::ptrdiff_t>(triangles.size())) flip_part(part);
    }

    /// Closed parts inside an odd number of others; all closed parts face outward here.
    [[nodiscard]] std::vector<std::size_t> find_cavities(const std::vector<Aabb>& boxes) const
    {
        std::vector<std::size_t> cavities;
        for (std::size_t inner = 0; inner < boxes.size(); ++inner) {
            int depth = 0;
            for (std::size_t outer = 0; outer < boxes.size(); ++outer)
                if (inner != outer && parts_.is_closed[inner] != 0 && parts_.is_closed[outer] != 0 &&
                    is_nested(inner, outer, boxes))
                    ++depth;
            if (depth % 2 == 1) cavities.push_back(inner);
        }
        return cavities;
    }

    [[nodiscard]] bool is_nested(std::size_t inner, std::size_t outer, const std::vector<Aabb>& boxes) const
    {
        const Aabb& a = boxes[inner];
        const Aabb& b = boxes[outer];
        if ((a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any()) return false;
        const PartSide side = side_of_part(mesh_, parts_.triangles[inner], parts_.triangles[outer], tolerance_);
        const Aabb reach = b.inflated(tolerance_);
        const bool can_be_inside = reach.contains(a.min) && reach.contains(a.max);
        if (options_.must_be_closed && side.inside > 0 && (side.outside > 0 || !can_be_inside))
            refuse_cut(side.place_inside);
        return side.inside > side.outside;
    }

    void name_parts()
    {
        std::vector<std::string> names;
        std::vector<int> part_of_triangle(mesh_.triangles.size());
        for (const std::vector<int>& triangles : parts_.triangles) {
            for (const int t : triangles)
                part_of_triangle[static_cast<std::size_t>(t)] = static_cast<int>(names.size());
            const auto first = static_cast<std::size_t>(triangles.front());
            const std::size_t named = mesh_.part_of_triangle.empty() ? 0 : mesh_.part_of_triangle[first];
            names.push_back(named < mesh_.part_names.size() ? mesh_.part_names[named] : "");
        }
        mesh_.part_of_triangle = std::move(part_of_triangle);
        mesh_.part_names = std::move(names);
        report_.parts = static_cast<int>(mesh_.part_names.size());
    }

    void check_crossings()
    {
        const bool is_small = mesh_.triangles.size() <= kMostForSelfCrossing;
        if (report_.parts == 1 && !is_small) return;
        const Crossings crossings = find_crossings(mesh_, tolerance_, is_small);
        if (crossings.between_parts) refuse_cut(crossings.between_parts->place);
        if (crossings.inside_a_part)
            note("its surface cuts itself at ", place(crossings.inside_a_part->place), "; volumes there count twice");
    }

    [[noreturn]] void refuse_cut(const Vec3d& at) const
    {
        refuse("has parts that cut each other at ", place(at), "; parts may touch or lie inside each other");
    }

    TriangleMesh& mesh_;
    const MeshCheckOptions& options_;
    MeshCheckReport report_;
    ConnectedParts parts_;
    double tolerance_ = 0.0; ///< [m]
};

} // namespace

MeshCheckReport check_mesh(TriangleMesh& mesh, const MeshCheckOptions& options)
{
    require(options.particle_spacing >= 0.0 && std::isfinite(options.particle_spacing),
            "particle_spacing of a mesh check must be >= 0 m and finite", options.particle_spacing);
    require(mesh.part_of_triangle.empty() || mesh.part_of_triangle.size() == mesh.triangles.size(),
            "part_of_triangle must be empty or have one entry per triangle", mesh.part_of_triangle.size());
    return MeshChecker(mesh, options).run();
}

} // namespace flotsam
