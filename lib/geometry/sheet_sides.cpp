#include "geometry/sheet_sides.hpp"

#include "geometry/disjoint_sets.hpp"
#include "geometry/mesh_connectivity.hpp"
#include "geometry/offset_surface.hpp"
#include "geometry/plane_cut.hpp"
#include "geometry/triangle_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace flotsam {
namespace {

constexpr double kOpposite = -0.5;     ///< cosine of two normals below which faces are opposite
constexpr double kSameFace = 0.766;    ///< cosine of 40 degrees: neighbours that bend less are one face
constexpr double kLeastThin = 0.2;     ///< of the surface, for a sheet
constexpr double kMostSame = 0.02;     ///< of the thin surface, that may have its own side opposite
constexpr double kFirstLooks = 2000.0; ///< at most, before all of a surface is looked at
constexpr int kPiecesOfFirstLook = 3, kPiecesAlong = 8; ///< an edge of a triangle, at most

/// Where a surface has an opposite face within two insets.
struct Thinness {
    struct Pair {
        std::size_t triangle, opposite;
        double area, distance;
    };
    std::vector<Pair> pairs;
    std::vector<double> area; ///< of each triangle [m^2]
    std::vector<double> thin; ///< what of it has an opposite face
    std::vector<double> bare; ///< what has none, although no ball of the inset fits below
};

class ThinnessProbe {
  public:
    ThinnessProbe(const SurfaceQuery& surface, const SurfaceSampleSettings& settings)
        : surface_(surface), spacing_(settings.spacing), offset_(surface, settings)
    {
    }

    /// By some pieces, at equal steps of area: most surfaces are thick.
    [[nodiscard]] bool is_mostly_thick() const
    {
        const std::vector<TrianglePiece> pieces = pieces_of(surface_.mesh(), spacing_, kPiecesOfFirstLook);
        double all = 0.0, met = 0.0, asked = 0.0;
        for (const TrianglePiece& piece : pieces) all += piece.area;
        int looks = 0, thin = 0;
        for (const TrianglePiece& piece : pieces) {
            met += piece.area;
            if (kFirstLooks * met < (asked + 1.0) * all) continue;
            asked = std::floor(kFirstLooks * met / all);
            thin += opposite(piece) ? 1 : 0;
            ++looks;
        }
        return thin < kLeastThin * looks;
    }

    [[nodiscard]] Thinness thinness() const
    {
        const std::size_t count = surface_.mesh().triangles.size();
        const std::vector<double> none(count, 0.0);
        Thinness result{{}, none, none, none};
        for (const TrianglePiece& piece : pieces_of(surface_.mesh(), spacing_, kPiecesAlong)) {
            result.area[piece.triangle] += piece.area;
            if (const auto other = opposite(piece)) {
                result.thin[piece.triangle] += piece.area;
                result.pairs.push_back({piece.triangle, other->triangle, piece.area, other->distance});
            } else if (!offset_.below(piece.center, -piece.normal)) {
                result.bare[piece.triangle] += piece.area;
            }
        }
        return result;
    }

    [[nodiscard]] const OffsetSurface& offset() const { return offset_; }

  private:
    struct Opposite {
        std::size_t triangle;
        double distance;
    };
    [[nodiscard]] std::optional<Opposite> opposite(const TrianglePiece& piece) const
    {
        const Vec3d inward = -piece.normal;
        const double reach = 2.0 * offset_.inset();
        const auto hit = surface_.sweep(piece.center + 1e-6 * reach * inward, piece.center + reach * inward);
        if (!hit) return std::nullopt;
        const auto t = static_cast<std::size_t>(hit->triangle);
        if (offset_.inward(t).dot(inward) > kOpposite) return std::nullopt;
        return Opposite{t, hit->fraction * reach};
    }

    const SurfaceQuery& surface_;
    double spacing_;
    OffsetSurface offset_;
};

/// Calls visit(a, b) for each two triangles that share an edge.
template <class Visit>
void visit_neighbours(const TriangleAdjacency& adjacency, Visit&& visit)
{
    for (std::size_t t = 0; t < adjacency.neighbours.size(); ++t)
        for (const TriangleAdjacency::Neighbour& other : adjacency.neighbours[t])
            if (other.triangle > static_cast<int>(t)) visit(t, static_cast<std::size_t>(other.triangle));
}

/// Vertices at the same place as one.
TriangleMesh welded(TriangleMesh mesh, const MeshTopology& topology)
{
    for (std::array<int, 3>& triangle : mesh.triangles)
        for (int& vertex : triangle) vertex = topology.first_at_place[static_cast<std::size_t>(vertex)];
    return mesh;
}

/// Whether of so much area little has an opposite face, and most no room for a ball either.
bool is_narrow(double thin, double bare, double area)
{
    return thin < 0.2 * area && bare > 0.5 * area;
}

/// Triangles of the narrow groups that lie between opposite groups.
std::vector<char> find_rims(DisjointSets& groups, const Thinness& thinness, const TriangleAdjacency& adjacency)
{
    const std::size_t count = thinness.area.size();
    std::vector<double> area(count, 0.0), thin(count, 0.0), bare(count, 0.0); // of groups
    for (std::size_t t = 0; t < count; ++t) {
        const std::size_t group = groups.find(t);
        area[group] += thinness.area[t];
        thin[group] += thinness.thin[t];
        bare[group] += thinness.bare[t];
    }
    std::set<std::pair<std::size_t, std::size_t>> opposites, beside; // groups
    for (const Thinness::Pair& pair : thinness.pairs)
        opposites.emplace(groups.find(pair.triangle), groups.find(pair.opposite));
    visit_neighbours(adjacency, [&](std::size_t a, std::size_t b) {
        a = groups.find(a);
        b = groups.find(b);
        if (a == b) return;
        beside.emplace(a, b);
        beside.emplace(b, a);
    });
    std::set<std::size_t> rims;
    for (const auto& [group, one] : beside)
        for (auto at = beside.lower_bound({group, 0}); at != beside.end() && at->first == group; ++at)
            if (opposites.count({one, at->second}) != 0) rims.insert(group);
    std::vector<char> is_rim(count);
    for (std::size_t t = 0; t < count; ++t) {
        const std::size_t group = groups.find(t);
        is_rim[t] = is_narrow(thin[group], bare[group], area[group]) && rims.count(group) != 0 ? 1 : 0;
    }
    return is_rim;
}

/// Neighbours that bend little.
DisjointSets faces_of(const TriangleAdjacency& adjacency, const OffsetSurface& offset)
{
    DisjointSets faces(adjacency.neighbours.size());
    visit_neighbours(adjacency, [&](std::size_t a, std::size_t b) {
        if (offset.inward(a).dot(offset.inward(b)) > kSameFace) faces.join(a, b);
    });
    return faces;
}

/// Narrow triangles that hang together, and others: a rounded rim is no face of its own. (Triangles at an edge of the
/// outside are narrow as well, but not between opposite ones.)
DisjointSets narrow_parts(const TriangleAdjacency& adjacency, const Thinness& thinness)
{
    DisjointSets parts(adjacency.neighbours.size());
    const auto narrow = [&](std::size_t t) { return is_narrow(thinness.thin[t], thinness.bare[t], thinness.area[t]); };
    visit_neighbours(adjacency, [&](std::size_t a, std::size_t b) {
        if (narrow(a) == narrow(b)) parts.join(a, b);
    });
    return parts;
}

TriangleMesh part_of(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles)
{
    TriangleMesh part;
    std::map<int, int> number;
    for (const std::size_t t : triangles) {
        std::array<int, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const int vertex = mesh.triangles[t][k];
            const auto [at, is_new] = number.emplace(vertex, static_cast<int>(part.vertices.size()));
            if (is_new) part.vertices.push_back(mesh.vertices[static_cast<std::size_t>(vertex)]);
            corners[k] = at->second;
        }
        part.triangles.push_back(corners);
    }
    return part;
}

/// Sets of triangles that hang together without the rims; nothing if opposite ones still do.
std::optional<DisjointSets> split_at(const std::vector<char>& is_rim, const TriangleAdjacency& adjacency,
                                     const Thinness& thinness)
{
    DisjointSets sides(is_rim.size());
    visit_neighbours(adjacency, [&](std::size_t a, std::size_t b) {
        if (is_rim[a] == 0 && is_rim[b] == 0) sides.join(a, b);
    });
    double thin = 0.0, same = 0.0;
    for (const Thinness::Pair& pair : thinness.pairs) {
        thin += pair.area;
        if (sides.find(pair.triangle) == sides.find(pair.opposite)) same += pair.area;
    }
    return same > kMostSame * thin ? std::nullopt : std::optional<DisjointSets>(std::move(sides));
}

SheetSides sides_of_shell(const SurfaceQuery& surface, const SurfaceSampleSettings& settings)
{
    const TriangleMesh& mesh = surface.mesh();
    const ThinnessProbe probe(surface, settings);
    if (probe.is_mostly_thick()) return {};
    const Thinness thinness = probe.thinness();
    const TriangleMesh joined_up = welded(mesh, probe.offset().topology());
    const TriangleAdjacency adjacency = triangle_adjacency(joined_up);
    DisjointSets groups = faces_of(adjacency, probe.offset());
    std::vector<char> is_rim = find_rims(groups, thinness, adjacency);
    std::optional<DisjointSets> parts = split_at(is_rim, adjacency, thinness);
    if (!parts) {
        groups = narrow_parts(adjacency, thinness);
        is_rim = find_rims(groups, thinness, adjacency);
        parts = split_at(is_rim, adjacency, thinness);
    }
    if (!parts) return {};
    std::map<std::size_t, std::vector<std::size_t>> triangles;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (is_rim[t] == 0) triangles[parts->find(t)].push_back(t);
    SheetSides result;
    for (const auto& [first, part] : triangles) result.sides.push_back(part_of(joined_up, part));
    double thin = 0.0;
    for (const Thinness::Pair& pair : thinness.pairs) {
        thin += pair.area;
        result.thickness += pair.area * pair.distance;
    }
    result.thickness /= thin;
    return result;
}

} // namespace

SheetSides sheet_sides(const SurfaceQuery& surface, const SurfaceSampleSettings& settings)
{
    using Solid = SurfaceSampleSettings::Solid;
    if (settings.inset == 0.0 || settings.solid == Solid::outside) return {};
    const auto split = [&](const SurfaceQuery& of) {
        if (settings.solid == Solid::both) return SheetSides{{of.mesh(), flipped(of.mesh())}, 0.0};
        return sides_of_shell(of, settings);
    };
    if (settings.dimensions == 3) return split(surface);
    return split(SurfaceQuery(ribbon(cut_at_y0(surface.mesh()), surface.bounds().size().maxCoeff())));
}

} // namespace flotsam
