// Writes the meshes of this folder: make_meshes [folder]. Z up, metres, triangles with edges of 1 to 2 centimetres.
// Coordinates are rounded to a micrometre, so that every machine writes the same bytes.

#include "mesh_builder.hpp"
#include "mesh_writers.hpp"

#include <filesystem>
#include <iostream>
#include <numbers>

namespace {

using meshes::Builder;
using meshes::Point;
using meshes::Row;

constexpr double kPi = std::numbers::pi;
constexpr double kEdge = 0.013; // aimed at [m]

int pieces(double length)
{
    return std::max(1, static_cast<int>(std::lround(length / kEdge)));
}

/// The hull of Wigley's model y = (B/2)(1 - (2x/L)^2)(1 - (z/T)^2) under water, upright sides above it, and a deck.
Builder wigley_hull()
{
    constexpr double length = 0.60, breadth = 0.16, draft = 0.08, freeboard = 0.06;
    const int stations = pieces(length), wet = pieces(draft), dry = pieces(freeboard);
    const auto side = [&](int station, int level, double sign) {
        const double x = length * (static_cast<double>(station) / stations - 0.5);
        const double z = level <= wet ? draft * (static_cast<double>(level) / wet - 1.0)
                                      : freeboard * static_cast<double>(level - wet) / dry;
        const double below = std::min(z, 0.0) / draft, along = 2.0 * x / length;
        return Point{x, sign * 0.5 * breadth * (1.0 - along * along) * (1.0 - below * below), z};
    };

    Builder hull;
    for (const double sign : {1.0, -1.0}) // port, starboard; they share the stems and the keel
        for (int level = 0; level < wet + dry; ++level)
            for (int station = 0; station < stations; ++station) {
                // Corners so that the diagonals rise away from the stems: one that joins stem and keel were both
                // sides'.
                const int away = 2 * station < stations ? 1 : 0;
                const int a = hull.vertex(side(station + 1 - away, level, sign)),
                          b = hull.vertex(side(station + away, level, sign)),
                          c = hull.vertex(side(station + away, level + 1, sign)),
                          d = hull.vertex(side(station + 1 - away, level + 1, sign));
                const bool turned = (sign > 0.0) == (away == 1);
                turned ? hull.triangle(a, c, b) : hull.triangle(a, b, c);
                turned ? hull.triangle(a, d, c) : hull.triangle(a, c, d);
            }
    Row before;
    for (int station = 0; station <= stations; ++station) { // the deck, as fine across as along
        const Point port = side(station, wet + dry, 1.0);
        const int across = pieces(2.0 * port[1]);
        Row beam;
        for (int k = 0; k <= across; ++k)
            beam.push_back(hull.vertex({port[0], port[1] * (1.0 - 2.0 * k / across), port[2]}));
        if (station == 0 || station == stations) beam.resize(1);
        if (station > 0) hull.strip(beam, before);
        before = beam;
    }
    return hull;
}

Builder ring_buoy()
{
    constexpr double major = 0.10, minor = 0.035;
    const int around = 4 * pieces(0.5 * kPi * (major + 0.5 * minor)), about = 4 * pieces(0.5 * kPi * minor);
    Builder ring;
    Row before;
    for (int i = 0; i <= around; ++i) {
        Row circle;
        for (int k = 0; k <= about; ++k) {
            const double u = 2.0 * kPi * i / around, v = 2.0 * kPi * k / about;
            const double radius = major + minor * std::cos(v);
            circle.push_back(ring.vertex({radius * std::cos(u), radius * std::sin(u), minor * std::sin(v)}));
        }
        if (i > 0) ring.strip(before, circle);
        before = circle;
    }
    return ring;
}

/// An open boat of plates, flat-bottomed, its sides and ends raked. The origin is in the middle, under the bottom.
Builder punt()
{
    constexpr double height = 0.14, plate = 0.004;
    constexpr std::array<double, 2> at_bottom = {0.17, 0.10}, at_rim = {0.25, 0.14}; // half lengths, half breadths
    const int along = pieces(2.0 * at_bottom[0]), across = pieces(2.0 * at_bottom[1]), up = pieces(height);
    Builder boat;
    // A point of the outside at a height, or of the inside, which is a plate's thickness away.
    const auto point = [&](double z, double inset, double s, double t) {
        const auto half = [&](int k) { return at_bottom[k] + (at_rim[k] - at_bottom[k]) * z / height - inset; };
        return boat.vertex({(2.0 * s - 1.0) * half(0), (2.0 * t - 1.0) * half(1), z});
    };
    const auto ring = [&](double z, double inset) {
        Row row;
        for (int k = 0; k < along; ++k) row.push_back(point(z, inset, static_cast<double>(k) / along, 0.0));
        for (int k = 0; k < across; ++k) row.push_back(point(z, inset, 1.0, static_cast<double>(k) / across));
        for (int k = along; k > 0; --k) row.push_back(point(z, inset, static_cast<double>(k) / along, 1.0));
        for (int k = across; k > 0; --k) row.push_back(point(z, inset, 0.0, static_cast<double>(k) / across));
        row.push_back(row.front());
        return row;
    };
    const auto bottom = [&](double z, double inset, bool faces_up) {
        for (int j = 0; j < across; ++j) {
            Row low, high;
            for (int k = 0; k <= along; ++k) {
                const double s = static_cast<double>(k) / along;
                low.push_back(point(z, inset, s, static_cast<double>(j) / across));
                high.push_back(point(z, inset, s, static_cast<double>(j + 1) / across));
            }
            faces_up ? boat.strip(high, low) : boat.strip(low, high);
        }
    };
    bottom(0.0, 0.0, false);
    for (int k = 0; k < up; ++k) boat.strip(ring(height * (k + 1) / up, 0.0), ring(height * k / up, 0.0));
    boat.strip(ring(height, plate), ring(height, 0.0));
    const auto inside = [&](int k) { return ring(plate + (height - plate) * k / up, plate); };
    for (int k = up; k > 0; --k) boat.strip(inside(k - 1), inside(k));
    bottom(plate, plate, true);
    return boat;
}

/// A solid of revolution about z. `profile`: (radius, z) from the lowest point of the axis to the highest.
Builder revolved(const std::vector<std::array<double, 2>>& profile)
{
    Builder solid;
    const auto circle = [&](double radius, double z) {
        const int around = radius > 0.0 ? std::max(8, pieces(2.0 * kPi * radius)) : 0;
        Row row;
        for (int k = 0; k <= around; ++k) {
            const double angle = around > 0 ? 2.0 * kPi * k / around : 0.0;
            row.push_back(solid.vertex({radius * std::cos(angle), radius * std::sin(angle), z}));
        }
        return row;
    };
    Row before = circle(profile[0][0], profile[0][1]);
    for (std::size_t corner = 1; corner < profile.size(); ++corner) {
        const auto [r0, z0] = profile[corner - 1];
        const auto [r1, z1] = profile[corner];
        const int count = pieces(std::hypot(r1 - r0, z1 - z0));
        for (int k = 1; k <= count; ++k) {
            const double t = static_cast<double>(k) / count;
            const Row next = circle(r0 + t * (r1 - r0), z0 + t * (z1 - z0));
            solid.strip(next, before);
            before = next;
        }
    }
    return solid;
}

/// Keel weight, stem, float, mast and top mark. The origin is in the float, at the height of its lower edge.
Builder channel_marker()
{
    return revolved({{0.0, -0.16},
                     {0.035, -0.16},
                     {0.035, -0.12},
                     {0.016, -0.105},
                     {0.016, -0.04},
                     {0.075, 0.0},
                     {0.075, 0.05},
                     {0.02, 0.075},
                     {0.014, 0.19},
                     {0.032, 0.20},
                     {0.032, 0.24},
                     {0.0, 0.24}});
}

/// A box with its edges cut off at 45 degrees.
Builder cargo_crate()
{
    constexpr std::array<double, 3> half = {0.08, 0.06, 0.06};
    constexpr double bevel = 0.008;
    Builder crate;
    // A point of the face `axis` = sign, at fractions s and t of its flat part along the two axes after `axis`.
    const auto on_face = [&](int axis, double sign, double s, double t) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Point p{};
        p[axis] = sign * half[axis];
        p[u] = (2.0 * s - 1.0) * (half[u] - bevel);
        p[v] = (2.0 * t - 1.0) * (half[v] - bevel);
        return crate.vertex(p);
    };
    const auto count = [&](int axis) { return pieces(2.0 * (half[axis] - bevel)); };
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const double sign : {-1.0, 1.0}) {
            for (int i = 0; i < count(u); ++i) { // the face
                Row low, high;
                for (int k = 0; k <= count(v); ++k) {
                    const double t = static_cast<double>(k) / count(v);
                    low.push_back(on_face(axis, sign, static_cast<double>(i) / count(u), t));
                    high.push_back(on_face(axis, sign, static_cast<double>(i + 1) / count(u), t));
                }
                sign > 0.0 ? crate.strip(low, high) : crate.strip(high, low);
            }
            for (const double other : {-1.0, 1.0}) { // the edge to the face u = other, along v
                Row mine, theirs;
                for (int k = 0; k <= count(v); ++k) {
                    const double t = static_cast<double>(k) / count(v);
                    mine.push_back(on_face(axis, sign, 0.5 + 0.5 * other, t));
                    theirs.push_back(on_face(u, other, t, 0.5 + 0.5 * sign));
                }
                sign* other > 0.0 ? crate.strip(mine, theirs) : crate.strip(theirs, mine);
            }
        }
    }
    for (int corner = 0; corner < 8; ++corner) {
        const double x = corner & 1, y = (corner >> 1) & 1, z = (corner >> 2) & 1;
        const int a = on_face(0, 2.0 * x - 1.0, y, z), b = on_face(1, 2.0 * y - 1.0, z, x),
                  c = on_face(2, 2.0 * z - 1.0, x, y);
        (static_cast<int>(x + y + z) % 2 == 1) ? crate.triangle(a, b, c) : crate.triangle(a, c, b);
    }
    return crate;
}

} // namespace

int main(int argument_count, char** arguments)
try {
    const std::filesystem::path folder = argument_count > 1 ? arguments[1] : ".";
    std::filesystem::create_directories(folder);
    meshes::write_obj(folder / "hull.obj", wigley_hull().closed("hull"));
    meshes::write_obj(folder / "punt.obj", punt().closed("punt"));
    meshes::write_stl(folder / "ring_buoy.stl", ring_buoy().closed("ring_buoy"));
    meshes::write_ply(folder / "channel_marker.ply", channel_marker().closed("channel_marker"));
    meshes::write_glb(folder / "crate.glb", cargo_crate().closed("crate"));
    return 0;
} catch (const std::exception& problem) {
    std::cerr << "make_meshes: " << problem.what() << '\n';
    return 1;
}
