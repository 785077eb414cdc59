#include "flotsam/geometry/surface_samples.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/crease_samples.hpp"
#include "geometry/layer_samples.hpp"
#include "geometry/outline_samples.hpp"
#include "geometry/sheet_sides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flotsam {
namespace {

bool is_closed(const MeshTopology& mesh)
{
    return std::find(mesh.on_boundary.begin(), mesh.on_boundary.end(), true) == mesh.on_boundary.end();
}

/// Fins without thickness have their solid on the wrong side of both faces.
void drop_wrong_side(std::vector<OffsetPoint>& samples, const SurfaceQuery& surface,
                     const SurfaceSampleSettings& settings)
{
    const bool inside = settings.solid == SurfaceSampleSettings::Solid::inside;
    std::erase_if(samples, [&](const OffsetPoint& sample) { return surface.inside(sample.position) != inside; });
}

bool has_wrong_side(const SurfaceSampleSettings& settings, const MeshTopology& mesh)
{
    return settings.inset > 0.0 && settings.solid != SurfaceSampleSettings::Solid::both && is_closed(mesh);
}

void require_valid(const SurfaceSampleSettings& settings)
{
    require(settings.spacing > 0.0, "sample spacing must be > 0 [m]", settings.spacing);
    require(settings.inset >= 0.0, "inset of samples must be >= 0 [m]", settings.inset);
    require(settings.dimensions == 2 || settings.dimensions == 3, "dimensions must be 2 or 3", settings.dimensions);
}

/// `sides`: one set of points, or of a sheet one for each side.
SurfaceSamples samples_at(const std::vector<std::vector<OffsetPoint>>& sides, bool is_sheet)
{
    SurfaceSamples samples;
    std::size_t thin = 0;
    for (std::size_t side = 0; side < sides.size(); ++side) {
        for (const OffsetPoint& point : sides[side]) {
            samples.positions.push_back(point.position);
            samples.depth.push_back(point.depth);
            thin += point.thin ? 1 : 0;
            if (!is_sheet) continue;
            samples.normal.push_back(point.thin ? Vec3d(Vec3d::Zero()) : Vec3d(-point.direction));
            samples.side.push_back(static_cast<std::int32_t>(side));
        }
    }
    const auto count = static_cast<double>(samples.positions.size());
    if (thin > 0) samples.thin_fraction = static_cast<double>(thin) / count;
    return samples;
}

} // namespace

SurfaceSamples sample_surface(const SurfaceQuery& surface, const SurfaceSampleSettings& settings,
                              const Workers& workers)
{
    require_valid(settings);
    if (settings.dimensions == 3) return SurfaceSampler(surface, settings, 1e300).sample(0, workers).samples;
    std::vector<std::vector<OffsetPoint>> points = sample_outline(surface, settings);
    const bool is_sheet = points.size() > 1;
    if (!is_sheet && has_wrong_side(settings, topology(surface.mesh())))
        drop_wrong_side(points.front(), surface, settings);
    return samples_at(points, is_sheet);
}

struct SurfaceSampler::Impl {
    static constexpr double kMargin = 5.0; ///< spacings around a part in which it is chosen as well, and dropped

    /// A side of a sheet, or all of a surface that is none.
    struct Side {
        std::unique_ptr<const SurfaceQuery> own; ///< surface of a sheet's side
        SurfaceSampleSettings settings;
        OffsetSurface offset;
        bool drops_wrong_side;
        std::vector<OffsetPoint> creases;
        std::vector<std::vector<OffsetPoint>> borders; ///< of each part that was sampled: its samples near other parts

        Side(const SurfaceQuery& surface, const SurfaceSampleSettings& given)
            : settings(given), offset(surface, given), drops_wrong_side(has_wrong_side(given, offset.topology())),
              creases(sample_creases(offset, given.spacing))
        {
        }
        /// Only the reference of OffsetSurface to `surface` is kept.
        Side(std::unique_ptr<const SurfaceQuery> surface, const SurfaceSampleSettings& given) : Side(*surface, given)
        {
            own = std::move(surface);
        }
    };

    const SurfaceQuery& surface;
    SurfaceSampleSettings settings;
    std::vector<Side> sides;
    bool is_sheet;
    Vec3d low, part_size;
    std::array<int, 3> counts{};
    std::vector<char> is_sampled;

    Impl(const SurfaceQuery& of, const SurfaceSampleSettings& given, double size) : surface(of), settings(given)
    {
        SurfaceSampleSettings of_side = given;
        of_side.solid = SurfaceSampleSettings::Solid::inside;
        for (const TriangleMesh& side : sheet_sides(of, given).sides)
            sides.emplace_back(std::make_unique<const SurfaceQuery>(side), of_side);
        is_sheet = !sides.empty();
        if (!is_sheet) sides.emplace_back(of, given);
        const Aabb box = surface.bounds();
        low = box.min;
        std::size_t total = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double extent = box.size()[static_cast<Eigen::Index>(axis)];
            counts[axis] = static_cast<int>(std::clamp(std::floor(extent / size), 1.0, 1000.0));
            part_size[static_cast<Eigen::Index>(axis)] = extent / counts[axis];
            total *= static_cast<std::size_t>(counts[axis]);
        }
        is_sampled.assign(total, 0);
        for (Side& side : sides) side.borders.resize(total);
    }

    [[nodiscard]] int along(int axis, double x) const
    {
        const int last = counts[static_cast<std::size_t>(axis)] - 1;
        if (last == 0) return 0;
        return static_cast<int>(
            std::clamp(std::floor((x - low[axis]) / part_size[axis]), 0.0, static_cast<double>(last)));
    }
    [[nodiscard]] std::size_t index(int x, int y, int z) const
    {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(counts[0]) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(counts[1]) * static_cast<std::size_t>(z));
    }
    [[nodiscard]] std::size_t part_of(const Vec3d& p) const
    {
        return index(along(0, p.x()), along(1, p.y()), along(2, p.z()));
    }
    void visit_parts(const Aabb& box, FunctionRef<void(std::size_t part)> visit) const
    {
        for (int z = along(2, box.min.z()); z <= along(2, box.max.z()); ++z)
            for (int y = along(1, box.min.y()); y <= along(1, box.max.y()); ++y)
                for (int x = along(0, box.min.x()); x <= along(0, box.max.x()); ++x) visit(index(x, y, z));
    }
    void sample_side(Side& side, std::size_t part, const LayerPart& layer, const Workers& workers,
                     std::vector<OffsetPoint>& own, std::vector<OffsetPoint>& around);
    /// Parts at the border have all that is beyond.
    [[nodiscard]] Aabb box_of(std::size_t part) const
    {
        const std::size_t nx = static_cast<std::size_t>(counts[0]), ny = static_cast<std::size_t>(counts[1]);
        const std::array<std::size_t, 3> at = {part % nx, part / nx % ny, part / nx / ny};
        Aabb box{Vec3d::Constant(-1e300), Vec3d::Constant(1e300)};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<Eigen::Index>(k);
            const double begin = low[axis] + static_cast<double>(at[k]) * part_size[axis];
            if (at[k] > 0) box.min[axis] = begin;
            if (static_cast<int>(at[k]) + 1 < counts[k]) box.max[axis] = begin + part_size[axis];
        }
        return box;
    }
};

SurfaceSampler::SurfaceSampler(const SurfaceQuery& surface, const SurfaceSampleSettings& settings, double part_size)
{
    require_valid(settings);
    require(settings.dimensions == 3, "a surface is sampled in parts in 3 dimensions only", settings.dimensions);
    require(part_size >= 4.0 * Impl::kMargin * settings.spacing, "a part must be 20 sample spacings wide or more [m]",
            part_size);
    impl_ = std::make_unique<Impl>(surface, settings, part_size);
}

SurfaceSampler::~SurfaceSampler() = default;

std::size_t SurfaceSampler::parts() const
{
    return impl_->is_sampled.size();
}

bool SurfaceSampler::is_sampled(std::size_t part) const
{
    return impl_->is_sampled[part] != 0;
}

void SurfaceSampler::visit_parts(const Aabb& box, FunctionRef<void(std::size_t part)> visit) const
{
    impl_->visit_parts(box, visit);
}

SurfaceSampler::Part SurfaceSampler::sample(std::size_t part, const Workers& workers)
{
    Impl& impl = *impl_;
    require(part < parts() && !is_sampled(part), "no part of this number is left to be sampled",
            static_cast<double>(part));
    const double d = impl.settings.spacing;
    const Aabb box = impl.box_of(part);
    LayerPart layer{box.inflated(Impl::kMargin * d), box.inflated(d), {}};
    for (int side = 0; side < 6; ++side) {
        Vec3d beyond =
            0.5 * (box.min.cwiseMax(impl.surface.bounds().min) + box.max.cwiseMin(impl.surface.bounds().max));
        beyond[side / 2] = (side % 2 == 0 ? layer.region.min : layer.region.max)[side / 2];
        layer.is_continued[static_cast<std::size_t>(side)] = is_sampled(impl.part_of(beyond));
    }
    std::vector<std::vector<OffsetPoint>> own, around;
    for (Impl::Side& side : impl.sides) {
        own.emplace_back();
        around.emplace_back();
        impl.sample_side(side, part, layer, workers, own.back(), around.back());
    }
    impl.is_sampled[part] = 1;
    return {samples_at(own, impl.is_sheet), samples_at(around, impl.is_sheet)};
}

/// Of a side the samples in the part, and those around it.
void SurfaceSampler::Impl::sample_side(Side& side, std::size_t part, const LayerPart& layer, const Workers& workers,
                                       std::vector<OffsetPoint>& own, std::vector<OffsetPoint>& around)
{
    std::vector<OffsetPoint> fixed;
    visit_parts(layer.region, [&](std::size_t other) {
        for (const OffsetPoint& point : side.borders[other])
            if (layer.region.contains(point.position)) fixed.push_back(point);
    });
    const auto known = static_cast<std::ptrdiff_t>(fixed.size());
    for (const OffsetPoint& point : side.creases)
        if (layer.region.contains(point.position) && is_sampled[part_of(point.position)] == 0) fixed.push_back(point);
    std::vector<OffsetPoint> all = sample_layer(side.offset, side.settings, std::move(fixed), layer, workers);

    around.assign(all.begin(), all.begin() + known);
    for (auto point = all.begin() + known; point != all.end(); ++point) {
        const std::size_t at = part_of(point->position);
        // What fills a gap just beyond the border of a part that has its samples is not dropped.
        const bool fills_gap = is_sampled[at] != 0 && layer.moves.contains(point->position);
        (at == part || fills_gap ? own : around).push_back(*point);
    }
    if (side.drops_wrong_side) {
        drop_wrong_side(own, side.offset.surface(), side.settings);
        drop_wrong_side(around, side.offset.surface(), side.settings);
    }
    const Aabb core = box_of(part).inflated(-kMargin * settings.spacing);
    for (const OffsetPoint& point : own)
        if (!core.contains(point.position)) side.borders[part].push_back(point);
}

} // namespace flotsam
