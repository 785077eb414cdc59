#include "flotsam/core/contracts.hpp"
#include "flotsam/geometry/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flotsam {
namespace {

/// Both sides of a Wigley hull as grids of stations and levels that share the stems and the keel, and its deck.
class HullBuilder {
  public:
    HullBuilder(const WigleyHull& hull, int stations, int levels)
        : hull_(hull), stations_(stations), wet_(levels),
          rows_(levels + static_cast<int>(std::ceil(hull.freeboard / (hull.draft / levels) * (1.0 - 1e-9))))
    {
    }

    TriangleMesh build()
    {
        for (const int side : {0, 1})
            for (int station = 0; station <= stations_; ++station)
                for (int row = 0; row <= rows_; ++row) index_.push_back(vertex(station, row, side));
        for (int station = 0; station < stations_; ++station) {
            for (int row = 0; row < rows_; ++row) add_panels(station, row);
            add_triangle(at(station, rows_, 0), at(station + 1, rows_, 0), at(station + 1, rows_, 1));
            add_triangle(at(station, rows_, 0), at(station + 1, rows_, 1), at(station, rows_, 1));
        }
        return std::move(mesh_);
    }

  private:
    [[nodiscard]] int at(int station, int row, int side) const
    {
        return index_[static_cast<std::size_t>((side * (stations_ + 1) + station) * (rows_ + 1) + row)];
    }
    [[nodiscard]] Vec3d point(int station, int row, int side) const
    {
        const double along = 2.0 * station / stations_ - 1.0;
        const double below = std::min(0.0, static_cast<double>(row) / wet_ - 1.0);
        const double above = row <= wet_ ? 0.0 : hull_.freeboard * (row - wet_) / (rows_ - wet_);
        const double half = 0.5 * hull_.breadth * (1.0 - along * along) * (1.0 - below * below);
        return Vec3d(0.5 * hull_.length * along, side == 0 ? -half : half, hull_.draft * below + above);
    }
    /// The second side takes over the vertices of stems and keel.
    int vertex(int station, int row, int side)
    {
        if (side == 1 && (station == 0 || station == stations_ || row == 0)) return at(station, row, 0);
        mesh_.vertices.push_back(point(station, row, side));
        return static_cast<int>(mesh_.vertices.size()) - 1;
    }
    /// A panel of each side. Its diagonal rises away from the stem: one that joined stem and keel would be both sides'.
    void add_panels(int station, int row)
    {
        const bool is_aft = 2 * station < stations_;
        for (const int side : {0, 1}) {
            const int a = at(station, row, side), b = at(station + 1, row, side), c = at(station + 1, row + 1, side),
                      d = at(station, row + 1, side);
            const std::array<std::array<int, 3>, 2> halves = is_aft
                                                                 ? std::array{std::array{a, b, c}, std::array{a, c, d}}
                                                                 : std::array{std::array{a, b, d}, std::array{b, c, d}};
            for (const auto& [p, q, r] : halves) side == 0 ? add_triangle(p, q, r) : add_triangle(p, r, q);
        }
    }
    /// Unless it is a line: where the deck ends in a point.
    void add_triangle(int a, int b, int c)
    {
        if (a != b && b != c && c != a) mesh_.triangles.push_back({a, b, c});
    }

    WigleyHull hull_;
    int stations_, wet_, rows_;
    std::vector<int> index_; ///< of each side's vertices, by station and row
    TriangleMesh mesh_;
};

} // namespace

TriangleMesh wigley_hull(const WigleyHull& hull, int stations, int levels)
{
    const auto require_size = [](double size, const char* what) {
        require(size > 0.0 && std::isfinite(size), std::string(what) + " of a hull must be > 0 m and finite", size);
    };
    require_size(hull.length, "the length");
    require_size(hull.breadth, "the breadth");
    require_size(hull.draft, "the draft");
    require(hull.freeboard >= 0.0 && std::isfinite(hull.freeboard), "the freeboard of a hull must be >= 0 m and finite",
            hull.freeboard);
    require(stations >= 2, "a hull must have at least two stations", stations);
    require(levels >= 1, "a hull must have at least one level", levels);
    return HullBuilder(hull, stations, levels).build();
}

} // namespace flotsam
