#include "scene/memory_need.hpp"

#include "flotsam/core/contracts.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace flotsam::scene {
namespace {

/// State, lists of neighbours (about 82, or 33) and the solver's arrays, of one particle or sample; runs took 2450 and
/// 1290 [bytes].
double bytes_per_particle(KernelKind kernel)
{
    return kernel == KernelKind::cubic ? 1400.0 : 2600.0;
}

/// What the machine has, or what a container or the shell leave of it [bytes].
double usable_memory()
{
    double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    for (const char* limit : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
        double allowed = 0.0;
        if (std::ifstream(limit) >> allowed && allowed > 0.0) bytes = std::min(bytes, allowed); // else "max": none
    }
    rlimit address_space{};
    if (getrlimit(RLIMIT_AS, &address_space) == 0 && address_space.rlim_cur != RLIM_INFINITY)
        bytes = std::min(bytes, static_cast<double>(address_space.rlim_cur));
    return bytes;
}

double area(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        sum += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
    return sum;
}

/// What takes particles or samples. In 2-D, where y is one metre long, a volume is an area and an area a length.
struct Taker {
    std::string name;
    Vec3d size;
    double volume = 0.0, surface = 0.0;

    [[nodiscard]] double particles(double spacing, int dimensions) const
    {
        return volume > 0.0 ? volume / std::pow(spacing, dimensions) : 0.0;
    }
    [[nodiscard]] double samples(double spacing, int dimensions) const
    {
        return surface > 0.0 ? surface / std::pow(spacing, dimensions - 1) : 0.0;
    }
    [[nodiscard]] double count(double spacing, int dimensions) const
    {
        return particles(spacing, dimensions) + samples(spacing, dimensions);
    }
};

std::vector<Taker> takers_of(const PreparedScene& prepared, int dimensions)
{
    std::vector<Taker> takers;
    for (const SceneBlock& block : prepared.blocks)
        takers.push_back({"a block of fluid", block.box.size(), block.box.size().prod(), 0.0});
    for (const TriangleMesh& mesh : prepared.fluid_meshes) {
        const Vec3d size = bounds(mesh).size();
        const double volume = dimensions == 2 ? size.x() * size.z() : mass_properties(mesh).volume;
        takers.push_back({"a mesh of fluid", size, volume, 0.0});
    }
    for (const PreparedWall& wall : prepared.walls)
        takers.push_back({wall.name, bounds(wall.mesh).size(), 0.0, area(wall.mesh)});
    for (const PreparedBody& body : prepared.bodies)
        takers.push_back({body.name, bounds(body.mesh).size(), 0.0, area(body.mesh)});
    return takers;
}

double total(const std::vector<Taker>& takers, double spacing, int dimensions)
{
    double sum = 0.0;
    for (const Taker& taker : takers) sum += taker.count(spacing, dimensions);
    return sum;
}

/// The smallest spacing, of two digits, that takes at most so many particles and samples.
double fitting_spacing(const std::vector<Taker>& takers, double spacing, int dimensions, double most_particles)
{
    while (!(total(takers, spacing, dimensions) <= most_particles)) spacing *= 1.02;
    const double digit = std::pow(10.0, std::floor(std::log10(spacing)) - 1.0);
    return std::ceil(spacing / digit) * digit;
}

} // namespace

void refuse_too_many_particles(const SceneFile& scene, PreparedScene& prepared)
{
    const double spacing = scene.particle_spacing;
    const int dimensions = scene.dimensions;
    const std::vector<Taker> takers = takers_of(prepared, dimensions);
    prepared.fluid_particles = prepared.boundary_samples = 0.0;
    for (const Taker& taker : takers) {
        prepared.fluid_particles += taker.particles(spacing, dimensions);
        prepared.boundary_samples += taker.samples(spacing, dimensions);
    }
    const double count = prepared.fluid_particles + prepared.boundary_samples;
    prepared.memory_bytes = count * bytes_per_particle(scene.kernel);
    const double memory = usable_memory();
    if (prepared.memory_bytes <= memory) return;
    const Taker& most = *std::max_element(takers.begin(), takers.end(), [&](const Taker& a, const Taker& b) {
        return a.count(spacing, dimensions) < b.count(spacing, dimensions);
    });
    std::ostringstream sentence;
    sentence.precision(3);
    sentence << scene.file.string() << ": particle_spacing " << spacing << " m would take about " << count
             << " particles and " << prepared.memory_bytes / 1e9 << " GB of memory, and there are " << memory / 1e9
             << " GB; a spacing of "
             << fitting_spacing(takers, spacing, dimensions, memory / bytes_per_particle(scene.kernel))
             << " m or more fits, or is " << most.name << ", " << most.size.x() << " x " << most.size.y() << " x "
             << most.size.z() << " m, too large?";
    throw InputError(sentence.str());
}

} // namespace flotsam::scene
