#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace meshes {

using Point = std::array<double, 3>;
using Row = std::vector<int>; ///< vertices one after the other

struct Mesh {
    std::string name;
    std::vector<Point> vertices; ///< [m]
    std::vector<std::array<int, 3>> triangles;
};

/// Collects triangles; points at the same micrometre are one vertex, triangles without area are dropped.
class Builder {
  public:
    int vertex(const Point& point)
    {
        std::array<long, 3> key{};
        std::transform(point.begin(), point.end(), key.begin(), [](double x) { return std::lround(1e6 * x); });
        const auto [entry, is_new] = number_.try_emplace(key, static_cast<int>(mesh_.vertices.size()));
        if (is_new)
            mesh_.vertices.push_back({1e-6 * static_cast<double>(key[0]), 1e-6 * static_cast<double>(key[1]),
                                      1e-6 * static_cast<double>(key[2])});
        return entry->second;
    }

    /// Counter-clockwise as seen from outside.
    void triangle(int a, int b, int c)
    {
        if (a != b && b != c && c != a) mesh_.triangles.push_back({a, b, c});
    }

    /// Triangles between two rows of any lengths that run side by side; counter-clockwise is along `right`, then back
    /// along `left`. Each next triangle takes the shorter of the two possible edges across.
    void strip(const Row& left, const Row& right)
    {
        std::size_t l = 0, r = 0;
        while (l + 1 < left.size() || r + 1 < right.size()) {
            const bool can_left = l + 1 < left.size(), can_right = r + 1 < right.size();
            const bool take_left =
                can_left && (!can_right || distance(left[l + 1], right[r]) < distance(left[l], right[r + 1]) - 1e-9);
            if (take_left) {
                triangle(left[l], right[r], left[l + 1]);
                ++l;
            } else {
                triangle(left[l], right[r], right[r + 1]);
                ++r;
            }
        }
    }

    /// The mesh, once it is known to be a solid: every edge runs once in each direction, the volume is positive.
    [[nodiscard]] Mesh closed(const std::string& name)
    {
        std::set<std::pair<int, int>> edges;
        double volume = 0.0;
        for (const auto& t : mesh_.triangles) {
            for (std::size_t k = 0; k < 3; ++k)
                if (!edges.insert({t[k], t[(k + 1) % 3]}).second) throw std::logic_error(name + ": an edge runs twice");
            const Point &a = at(t[0]), &b = at(t[1]), &c = at(t[2]);
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                       a[2] * (b[0] * c[1] - b[1] * c[0])) /
                      6.0;
        }
        for (const auto& [from, to] : edges)
            if (edges.count({to, from}) == 0) throw std::logic_error(name + ": an edge is open");
        if (!(volume > 0.0)) throw std::logic_error(name + ": it is inside out");
        mesh_.name = name;
        return mesh_;
    }

  private:
    [[nodiscard]] const Point& at(int vertex) const { return mesh_.vertices[static_cast<std::size_t>(vertex)]; }
    [[nodiscard]] double distance(int a, int b) const
    {
        return std::hypot(at(a)[0] - at(b)[0], at(a)[1] - at(b)[1], at(a)[2] - at(b)[2]);
    }

    Mesh mesh_;
    std::map<std::array<long, 3>, int> number_;
};

} // namespace meshes
