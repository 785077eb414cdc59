#include "flotsam/geometry/volume_samples.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/plane_cut.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace flotsam {
namespace {

using Site = std::array<std::int64_t, 2>;

/// `count` of the columns * rows sites of a layer, spread evenly: the next free ones along a sequence that covers the
/// plane evenly however long it is. **Source:** Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences".
std::vector<Site> spread_over_layer(std::int64_t columns, std::int64_t rows, std::int64_t count)
{
    std::vector<Site> sites;
    if (rows == 1) {
        for (std::int64_t k = 0; k < count; ++k) sites.push_back({(2 * k + 1) * columns / (2 * count), 0});
        return sites;
    }
    constexpr double kPlastic = 1.324717957244746; // what the golden ratio is to the line
    std::vector<bool> taken(static_cast<std::size_t>(columns * rows), false);
    for (std::int64_t k = 0; k < count; ++k) {
        const double u = 0.5 + static_cast<double>(k) / kPlastic,
                     v = 0.5 + static_cast<double>(k) / (kPlastic * kPlastic);
        const auto x = static_cast<std::int64_t>((u - std::floor(u)) * static_cast<double>(columns));
        const auto y = static_cast<std::int64_t>((v - std::floor(v)) * static_cast<double>(rows));
        std::int64_t site = y * columns + x;
        while (taken[static_cast<std::size_t>(site)]) site = (site + 1) % (columns * rows);
        taken[static_cast<std::size_t>(site)] = true;
        sites.push_back({site % columns, site / columns});
    }
    return sites;
}

void require_lattice(double spacing, int dimensions)
{
    require(spacing > 0.0, "particle spacing must be > 0 [m]", spacing);
    require(dimensions == 2 || dimensions == 3, "dimensions must be 2 or 3", dimensions);
}

/// Decides which points of a lattice lie in a mesh, whole blocks at once where they are far from its surface.
class LatticeFill {
  public:
    using Index = std::array<std::int64_t, 3>;

    LatticeFill(const SurfaceQuery& mesh, const Vec3d& origin, double spacing, const Index& counts)
        : mesh_(mesh), origin_(origin), spacing_(spacing)
    {
        fill({0, 0, 0}, counts);
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::vector<Vec3d> points() const
    {
        std::vector<Vec3d> points;
        points.reserve(count_);
        for (const auto& [low, high] : blocks_)
            for (std::int64_t z = low[2]; z < high[2]; ++z)
                for (std::int64_t y = low[1]; y < high[1]; ++y)
                    for (std::int64_t x = low[0]; x < high[0]; ++x) points.push_back(at({x, y, z}));
        return points;
    }

  private:
    [[nodiscard]] Vec3d at(const Index& i) const
    {
        return origin_ +
               spacing_ * Vec3d(static_cast<double>(i[0]), static_cast<double>(i[1]), static_cast<double>(i[2]));
    }
    void fill(const Index& low, const Index& high)
    {
        const Vec3d first = at(low), last = at({high[0] - 1, high[1] - 1, high[2] - 1});
        const Vec3d middle = 0.5 * (first + last);
        const double reach = 0.5 * (last - first).norm();
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
        if (high[axis] - low[axis] > 1 && mesh_.closest(middle).distance <= reach * (1.0 + 1e-9)) {
            Index split = high, rest = low;
            split[axis] = rest[axis] = (low[axis] + high[axis]) / 2;
            fill(low, split);
            fill(rest, high);
        } else if (mesh_.inside(middle)) {
            blocks_.emplace_back(low, high);
            count_ += static_cast<std::size_t>((high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]));
        }
    }

    const SurfaceQuery& mesh_;
    Vec3d origin_;
    double spacing_;
    std::size_t count_ = 0;
    std::vector<std::pair<Index, Index>> blocks_;
};

double volume(const TriangleMesh& mesh, const Vec3d& about)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d a = mesh.corner(t, 0) - about, b = mesh.corner(t, 1) - about, c = mesh.corner(t, 2) - about;
        sum += a.dot(b.cross(c)) / 6.0;
    }
    return sum;
}

/// A lattice centred on the box, with a row of points through its middle along an axis or half a spacing beside.
struct Lattice {
    Vec3d origin = Vec3d::Zero();
    LatticeFill::Index counts{1, 1, 1};
};

Lattice centred_lattice(const Aabb& box, double spacing, int dimensions, unsigned phase)
{
    Lattice lattice;
    for (int k = 0; k < 3; ++k) {
        if (dimensions == 2 && k == 1) continue;
        const double beside = (phase >> k) & 1U ? 0.0 : 0.5;
        const double steps = std::floor(0.5 * box.size()[k] / spacing - beside + 1e-9) + beside; // from the middle
        lattice.origin[k] = box.center()[k] - std::max(steps, 0.0) * spacing;
        lattice.counts[static_cast<std::size_t>(k)] = std::max<std::int64_t>(1, std::llround(2.0 * steps) + 1);
    }
    return lattice;
}

} // namespace

std::vector<Vec3d> fill_box(const Aabb& box, double spacing, int dimensions)
{
    require_lattice(spacing, dimensions);
    require(!box.empty(), "a box to fill must have min <= max");
    Vec3d size = box.size();
    if (dimensions == 2) size.y() = spacing;
    const auto along = [&](double length) { return std::max<std::int64_t>(1, std::llround(length / spacing)); };
    const std::int64_t columns = along(size.x()), rows = along(size.y()), per_layer = columns * rows;
    const double width = size.x() / static_cast<double>(columns), depth = size.y() / static_cast<double>(rows);
    const double cell = std::pow(spacing, 3), height = cell / (width * depth);
    // Where the top layer fills less than half of its height it would lie above the box.
    const double highest = std::max(size.z() - 0.25 * height, 0.5 * size.z());
    const double first_y = dimensions == 2 ? 0.0 : box.min.y() + 0.5 * depth;

    const std::int64_t total = std::llround(size.prod() / cell), full = total / per_layer;
    std::vector<Vec3d> points;
    points.reserve(static_cast<std::size_t>(total));
    const auto add = [&](std::int64_t x, std::int64_t y, std::int64_t layer) {
        const double above = std::min((static_cast<double>(layer) + 0.5) * height, highest);
        points.emplace_back(box.min.x() + (static_cast<double>(x) + 0.5) * width,
                            first_y + static_cast<double>(y) * depth, box.min.z() + above);
    };
    for (std::int64_t layer = 0; layer < full; ++layer)
        for (std::int64_t y = 0; y < rows; ++y)
            for (std::int64_t x = 0; x < columns; ++x) add(x, y, layer);
    for (const auto& [x, y] : spread_over_layer(columns, rows, total - full * per_layer)) add(x, y, full);
    return points;
}

std::vector<Vec3d> fill_mesh(const SurfaceQuery& closed, double spacing, int dimensions)
{
    require_lattice(spacing, dimensions);
    const double wanted = dimensions == 2 ? enclosed_area(cut_at_y0(closed.mesh())) / (spacing * spacing)
                                          : volume(closed.mesh(), closed.bounds().center()) / std::pow(spacing, 3);
    std::vector<Vec3d> best;
    double best_error = std::numeric_limits<double>::infinity();
    for (unsigned phase = 0; phase < 8; ++phase) {
        if (dimensions == 2 && (phase & 2U)) continue;
        const Lattice lattice = centred_lattice(closed.bounds(), spacing, dimensions, phase);
        const LatticeFill fill(closed, lattice.origin, spacing, lattice.counts);
        const double error = std::abs(static_cast<double>(fill.count()) - wanted);
        if (error >= best_error) continue;
        best_error = error;
        best = fill.points();
    }
    return best;
}

} // namespace flotsam
