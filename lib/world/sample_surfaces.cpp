#include "world/fluid_world_impl.hpp"

#include "world/fit_volumes.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <sstream>

namespace flotsam {

BoundaryCalibration FluidWorld::Impl::calibration() const
{
    return boundary_calibration(settings.kernel, settings.dimensions);
}

double FluidWorld::Impl::sample_inset() const
{
    return calibration().inset * spacing();
}

SurfaceSampleSettings FluidWorld::Impl::sample_settings(SurfaceSampleSettings::Solid solid) const
{
    SurfaceSampleSettings sampling;
    sampling.spacing = 0.7 * spacing();
    sampling.inset = sample_inset();
    sampling.dimensions = settings.dimensions;
    sampling.solid = solid;
    return sampling;
}

void FluidWorld::Impl::add_samples(std::size_t owner, const SurfaceSamples& samples, std::span<const double> volumes)
{
    const bool is_sheet = !samples.normal.empty();
    if (is_sheet) {
        boundary.normal.resize(boundary.size(), Vec4::Zero());
        boundary.normal_body.resize(boundary.size(), Vec4::Zero());
    }
    for (std::size_t b = 0; b < samples.positions.size(); ++b) {
        Vec4 position = Vec4::Zero();
        position.head<3>() = samples.positions[b].cast<Scalar>();
        boundary.position.push_back(position);
        boundary.volume.push_back(static_cast<Scalar>(volumes[b]));
        boundary.velocity.push_back(Vec4::Zero());
        boundary.owner.push_back(static_cast<std::int32_t>(owner));
        boundary.position_body.push_back(samples.positions[b]);
        if (!is_sheet) continue;
        Vec4 normal;
        normal << samples.normal[b].cast<Scalar>(), static_cast<Scalar>(samples.depth[b]);
        boundary.normal.push_back(normal);
        normal[3] = static_cast<Scalar>(samples.side[b]);
        boundary.normal_body.push_back(normal);
    }
    if (boundary.normal.empty()) return;
    boundary.normal.resize(boundary.size(), Vec4::Zero());
    boundary.normal_body.resize(boundary.size(), Vec4::Zero());
}

/// Of `samples`; those `around` are of the same surface and count in them. The sides of a sheet each for itself.
std::vector<double> FluidWorld::Impl::volumes_of(const SurfaceSamples& samples, const SurfaceSamples& around) const
{
    std::vector<double> volumes(samples.positions.size());
    const auto sides = samples.side.empty() ? 1 : 1 + *std::max_element(samples.side.begin(), samples.side.end());
    for (std::int32_t side = 0; side < sides; ++side) {
        std::vector<Vec3d> positions;
        std::vector<double> depths;
        std::vector<std::size_t> numbers;
        const auto take = [&](const SurfaceSamples& from, std::size_t b) {
            if (!from.side.empty() && from.side[b] != side) return false;
            positions.push_back(from.positions[b]);
            depths.push_back(from.depth[b]);
            return true;
        };
        for (std::size_t b = 0; b < samples.positions.size(); ++b)
            if (take(samples, b)) numbers.push_back(b);
        for (std::size_t b = 0; b < around.positions.size(); ++b) take(around, b);
        const std::vector<double> found =
            sample_volumes(positions, depths, settings.kernel, spacing(), settings.dimensions);
        for (std::size_t k = 0; k < numbers.size(); ++k) volumes[numbers[k]] = found[k];
    }
    return volumes;
}

/// Of what was sampled as one; null: it was not.
std::unique_ptr<Sheet> FluidWorld::Impl::sheet_of(const SurfaceQuery& query, const SurfaceSampleSettings& sampling,
                                                  const SurfaceSamples& samples) const
{
    if (samples.side.empty()) return nullptr;
    return std::make_unique<Sheet>(sheet_sides(query, sampling), spacing());
}

void FluidWorld::Impl::note_thin(const std::string& name, double fraction)
{
    if (!(fraction > 0.0)) return;
    std::ostringstream note;
    note << name << " is thinner than two layers of samples take, " << 2.0 * sample_inset() << " m, on "
         << std::lround(100.0 * fraction) << " % of its surface: one layer of samples in its middle";
    notes.push_back(note.str());
}

void FluidWorld::Impl::sample_body(std::size_t k)
{
    BodySurface& body = bodies[k];
    if (!body.query) return; // removed
    if (!copy_samples_of_twin(k)) {
        const SurfaceSampleSettings sampling = sample_settings(SurfaceSampleSettings::Solid::inside);
        const SurfaceSamples samples = sample_surface(*body.query, sampling, workers);
        body.sheet = sheet_of(*body.query, sampling, samples);
        body.thin_fraction = samples.thin_fraction;
        std::vector<double> volumes = volumes_of(samples, {});
        if (!body.sheet)
            fit_volumes(*body.query, {settings.kernel, settings.dimensions, spacing(), calibration().solid},
                        samples.positions, volumes, workers);
        add_samples(walls.size() + k, samples, volumes);
    }
    note_thin(body.name, body.thin_fraction);
}

/// Bodies of one shape come by the dozen, and have the same samples. False if there is no such body, or it is a sheet.
bool FluidWorld::Impl::copy_samples_of_twin(std::size_t k)
{
    const TriangleMesh& mesh = bodies[k].mesh;
    const auto is_twin = [&](const BodySurface& other) {
        return &other != &bodies[k] && other.query && !other.is_changed && !other.sheet &&
               other.mesh.triangles == mesh.triangles && other.mesh.vertices == mesh.vertices;
    };
    const auto twin = std::find_if(bodies.begin(), bodies.end(), is_twin);
    if (twin == bodies.end()) return false;
    const auto owner = static_cast<std::int32_t>(walls.size() + static_cast<std::size_t>(twin - bodies.begin()));
    const std::size_t all = boundary.size();
    for (std::size_t b = 0; b < all; ++b) {
        if (boundary.owner[b] != owner) continue;
        boundary.position.push_back(boundary.position[b]);
        boundary.volume.push_back(boundary.volume[b]);
        boundary.velocity.push_back(Vec4::Zero());
        boundary.owner.push_back(static_cast<std::int32_t>(walls.size() + k));
        boundary.position_body.push_back(boundary.position_body[b]);
    }
    if (boundary.size() == all) return false; // it has yet to get its own
    if (!boundary.normal.empty()) {
        boundary.normal.resize(boundary.size(), Vec4::Zero());
        boundary.normal_body.resize(boundary.size(), Vec4::Zero());
    }
    bodies[k].sheet.reset();
    bodies[k].thin_fraction = twin->thin_fraction;
    return true;
}

void FluidWorld::Impl::sample_surfaces()
{
    for (std::size_t k = 0; k < walls.size(); ++k) prepare_wall_samples(k);
    for (std::size_t k = 0; k < bodies.size(); ++k) sample_body(k);
}

SurfaceSampleSettings FluidWorld::Impl::wall_sampling(const Wall& wall) const
{
    using Solid = SurfaceSampleSettings::Solid;
    return sample_settings(wall.side == WallSide::inside    ? Solid::outside
                           : wall.side == WallSide::outside ? Solid::inside
                                                            : Solid::both);
}

/// A wall gets samples where water comes near: in parts of 32 to 64 spacings, since sampling costs the more the larger
/// the surface, and in memory as well.
void FluidWorld::Impl::prepare_wall_samples(std::size_t k)
{
    constexpr double kPart = 32.0; // spacings
    Wall& wall = walls[k];
    const SurfaceSampleSettings sampling = wall_sampling(wall);
    if (settings.dimensions == 3) {
        wall.sampler = std::make_unique<SurfaceSampler>(*wall.query, sampling, kPart * spacing());
        return;
    }
    const SurfaceSamples samples = sample_surface(*wall.query, sampling, workers);
    wall.sheet = sheet_of(*wall.query, sampling, samples);
    add_samples(k, samples, volumes_of(samples, {}));
    note_thin(wall.name, samples.thin_fraction);
}

/// Sets reached_parts: which of a wall's parts may have samples within reach of a particle.
void FluidWorld::Impl::find_reached_parts(const Wall& wall)
{
    const double reach = support() + sample_inset();
    const SurfaceSampler& sampler = *wall.sampler;
    const Aabb bounds = wall.query->bounds().inflated(reach);
    reached_parts.assign(sampler.parts(), 0);
    const auto in_reach = [&](const Vec4& low, const Vec4& high) {
        return Aabb{low.head<3>().cast<double>(), high.head<3>().cast<double>()}.inflated(reach);
    };
    workers.for_chunks(fluid.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        Vec4 low = fluid.position[begin], high = low; // particles of a chunk are neighbours, most often
        for (std::size_t i = begin; i < end; ++i) {
            low = low.cwiseMin(fluid.position[i]);
            high = high.cwiseMax(fluid.position[i]);
        }
        bool is_new = !(low.array() <= high.array()).all(); // not finite
        if (!is_new) sampler.visit_parts(in_reach(low, high), [&](std::size_t p) { is_new |= !sampler.is_sampled(p); });
        if (!is_new) return;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec4& at = fluid.position[i];
            if (!bounds.contains(at.head<3>().cast<double>())) continue; // nor what is not finite
            sampler.visit_parts(in_reach(at, at), [&](std::size_t part) {
                std::atomic_ref(reached_parts[part]).store(1, std::memory_order_relaxed);
            });
        }
    });
}

void FluidWorld::Impl::sample_walls_in_reach()
{
    for (std::size_t k = 0; k < walls.size(); ++k) {
        Wall& wall = walls[k];
        if (!wall.sampler) continue;
        find_reached_parts(wall);
        bool is_left = false;
        for (std::size_t part = 0; part < wall.sampler->parts(); ++part) {
            if (wall.sampler->is_sampled(part)) continue;
            if (reached_parts[part] == 0) {
                is_left = true;
                continue;
            }
            const SurfaceSampler::Part found = wall.sampler->sample(part, workers);
            if (!wall.sheet) wall.sheet = sheet_of(*wall.query, wall_sampling(wall), found.samples);
            add_samples(k, found.samples, volumes_of(found.samples, found.around));
            if (!wall.is_noted_thin) note_thin(wall.name, found.samples.thin_fraction);
            wall.is_noted_thin = wall.is_noted_thin || found.samples.thin_fraction > 0.0;
        }
        if (!is_left) wall.sampler.reset();
    }
}

} // namespace flotsam
