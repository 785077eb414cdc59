#include "scene/memory_need.hpp"

#include "flotsam/core/contracts.hpp"

#include <unistd.h>

#include <cmath>
#include <sstream>

namespace flotsam::scene {
namespace {

/// State, lists of about 35 neighbours and the solver's arrays, of one particle or sample.
constexpr double kBytesPerParticle = 1200.0;

double physical_memory() // [bytes]
{
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double area(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        sum += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
    return sum;
}

/// In 2-D, where y is one metre long, a volume is an area and an area a length.
double fluid_volume(const PreparedScene& prepared, int dimensions)
{
    double volume = 0.0;
    for (const SceneBlock& block : prepared.blocks) volume += block.box.size().prod();
    for (const TriangleMesh& mesh : prepared.fluid_meshes) {
        const Vec3d size = bounds(mesh).size();
        volume += dimensions == 2 ? size.x() * size.z() : mass_properties(mesh).volume;
    }
    return volume;
}

double surface_area(const PreparedScene& prepared)
{
    double sum = 0.0;
    for (const PreparedWall& wall : prepared.walls) sum += area(wall.mesh);
    for (const PreparedBody& body : prepared.bodies) sum += area(body.mesh);
    return sum;
}

/// The smallest spacing, of two digits, with which the memory suffices.
double fitting_spacing(double volume, double surface, int dimensions, double memory)
{
    double spacing = std::pow(volume * kBytesPerParticle / memory, 1.0 / dimensions);
    for (int k = 0; k < 200; ++k) {
        const double need = volume / std::pow(spacing, dimensions) + surface / std::pow(spacing, dimensions - 1);
        if (need * kBytesPerParticle <= memory) break;
        spacing *= 1.02;
    }
    const double digit = std::pow(10.0, std::floor(std::log10(spacing)) - 1.0);
    return std::ceil(spacing / digit) * digit;
}

} // namespace

void refuse_too_many_particles(const SceneFile& scene, PreparedScene& prepared)
{
    const double volume = fluid_volume(prepared, scene.dimensions), surface = surface_area(prepared);
    prepared.fluid_particles = volume / std::pow(scene.particle_spacing, scene.dimensions);
    prepared.boundary_samples = surface / std::pow(scene.particle_spacing, scene.dimensions - 1);
    prepared.memory_bytes = (prepared.fluid_particles + prepared.boundary_samples) * kBytesPerParticle;
    const double memory = physical_memory();
    if (prepared.memory_bytes <= memory) return;
    std::ostringstream sentence;
    sentence.precision(3);
    sentence << scene.file.string() << ": particle_spacing " << scene.particle_spacing << " m would take about "
             << prepared.fluid_particles + prepared.boundary_samples << " particles and " << prepared.memory_bytes / 1e9
             << " GB of memory, and this machine has " << memory / 1e9 << " GB; a spacing of "
             << fitting_spacing(volume, surface, scene.dimensions, memory) << " m or more fits";
    throw InputError(sentence.str());
}

} // namespace flotsam::scene
