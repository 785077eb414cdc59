#include "scene/memory_need.hpp"

#include "flotsam/core/contracts.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace flotsam::scene {
namespace {

/// State, lists of neighbours (about 82, or 33) and the solver's arrays, of one particle; runs took 1190 and 715, that
/// of their samples included [bytes].
double bytes_per_particle(KernelKind kernel)
{
    return kernel == KernelKind::cubic ? 900.0 : 1500.0;
}

constexpr double kBytesPerSample = 1000.0; ///< while a surface is sampled
constexpr double kSampleSpacing = 0.7;     ///< in particle spacings

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
    bool is_wall = false;
};

std::vector<Taker> takers_of(const PreparedScene& prepared, int dimensions)
{
    std::vector<Taker> takers;
    for (const SceneBlock& block : prepared.blocks)
        takers.push_back({"a block of fluid", block.box.size(), block.box.size().prod()});
    for (const TriangleMesh& mesh : prepared.fluid_meshes) {
        const Vec3d size = bounds(mesh).size();
        const double volume = dimensions == 2 ? size.x() * size.z() : mass_properties(mesh).volume;
        takers.push_back({"a mesh of fluid", size, volume});
    }
    for (const PreparedWall& wall : prepared.walls)
        takers.push_back({wall.name, bounds(wall.mesh).size(), 0.0, area(wall.mesh), true});
    for (const PreparedBody& body : prepared.bodies)
        takers.push_back({body.name, bounds(body.mesh).size(), 0.0, area(body.mesh)});
    return takers;
}

struct Need {
    double particles = 0.0, samples = 0.0;

    [[nodiscard]] double bytes(KernelKind kernel) const
    {
        return particles * bytes_per_particle(kernel) + samples * kBytesPerSample;
    }
};

Need need_of(std::span<const Taker> takers, double spacing, int dimensions)
{
    Need need;
    const double each = std::pow(kSampleSpacing * spacing, dimensions - 1);
    double wall_samples = 0.0;
    for (const Taker& taker : takers) {
        if (taker.volume > 0.0) need.particles += taker.volume / std::pow(spacing, dimensions);
        if (taker.surface > 0.0) (taker.is_wall ? wall_samples : need.samples) += taker.surface / each;
    }
    // In 3-D a wall is sampled where water comes near, and that wets no more than a layer of one particle would.
    const double most = need.particles / (kSampleSpacing * kSampleSpacing);
    need.samples += dimensions == 3 ? std::min(wall_samples, most) : wall_samples;
    return need;
}

/// The smallest spacing, of two digits, that takes at most so much memory.
double fitting_spacing(std::span<const Taker> takers, double spacing, const SceneFile& scene, double memory)
{
    while (!(need_of(takers, spacing, scene.dimensions).bytes(scene.kernel) <= memory)) spacing *= 1.02;
    const double digit = std::pow(10.0, std::floor(std::log10(spacing)) - 1.0);
    return std::ceil(spacing / digit) * digit;
}

} // namespace

void refuse_too_many_particles(const SceneFile& scene, PreparedScene& prepared)
{
    const double spacing = scene.particle_spacing;
    const int dimensions = scene.dimensions;
    const std::vector<Taker> takers = takers_of(prepared, dimensions);
    const Need need = need_of(takers, spacing, dimensions);
    prepared.fluid_particles = need.particles;
    prepared.boundary_samples = need.samples;
    prepared.memory_bytes = need.bytes(scene.kernel);
    const double memory = usable_memory();
    if (prepared.memory_bytes <= memory) return;
    const Taker& most = *std::max_element(takers.begin(), takers.end(), [&](const Taker& a, const Taker& b) {
        const auto bytes = [&](const Taker& taker) {
            return need_of({&taker, 1}, spacing, dimensions).bytes(scene.kernel);
        };
        return bytes(a) < bytes(b);
    });
    std::ostringstream sentence;
    sentence.precision(3);
    sentence << scene.file.string() << ": particle_spacing " << spacing << " m would take about "
             << need.particles + need.samples << " particles and " << prepared.memory_bytes / 1e9
             << " GB of memory, and there are " << memory / 1e9 << " GB; a spacing of "
             << fitting_spacing(takers, spacing, scene, memory) << " m or more fits, or is " << most.name << ", "
             << most.size.x() << " x " << most.size.y() << " x " << most.size.z() << " m, too large?";
    throw InputError(sentence.str());
}

} // namespace flotsam::scene
