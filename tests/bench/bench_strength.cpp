// How strongly a packing of particles resists shear: a vortex in a tank loses speed, and the more so the larger the
// pressure, which water would not do. 2-D, 40 x 40 spacings, 0.3 m/s, no viscosity of any kind.
//
// The column "relief" is packing_relief (lib/sph/forces/packing_stress): the stress of the packing is
// measured by its virial and its smooth part taken out of the forces. Amplitude after 2 s at 1, 9.81 and 100 m/s^2:
// 0.83, 0.52, 0 without, 0.86, 0.65, 0.31 with 0.75 (the default), 0.87, 0.69, 0.52 with 1. What was found on the way,
// with 0.85 and 1 of the stress and nothing special in the second layer from a solid (0.87, 0.75, 0.70 with 1):
// - Taken away along solids as well, it stirs still water (0.4 m/s after 2 s): the layers along a wall are
//   anisotropic at rest, the more so the deeper, and only what flow adds is wrong. So particles that touch samples
//   are left out; carrying the stress on to them from inside helps a ball more (released, s = 0.8: +1 % instead of
//   -10 %) but makes still water restless (0.27 % of sqrt(g depth) instead of 0.18).
// - Without smoothing first, it heats: 0.8 % of sqrt(g depth) at rest. Two passes instead of one: no better, no worse.
// - Without a bound of |<T>| a drop that is stretched (Monaghan 1994) gains 27 % of its energy, with 0.1 p 5 %,
//   with 0.03 p 1 %: at a free surface the virial of half a neighbourhood is no stress. Waves gain by the looser
//   bound (0.47 instead of 0.2 to 0.29 of the amplitude left after ten periods at 30 spacings), but so they would by
//   any such error.
// - What stirs still water is slow. A tank of 0.64 x 0.64 m, 0.3 m deep (15 layers), started as a lattice: mean speed
//   after 4, 10 and 20 s in % of sqrt(g depth)
//     without relief                                    0.32  0.12  0.08
//     0.6                                               0.28  0.15  0.10
//     0.85                                              0.45  0.55, and growing: one roll, up along the walls
//     1                                                 0.49  0.78
//     0.85, the second layer from the walls left out    0.33  0.21  0.34
//     0.75, likewise                                    0.29  0.13  0.09
//     1, of <T> the part along the strain rate alone    0.29  0.18
//     0.75, that part in the second layer (the method)  0.28  0.13  0.10 (after 14 s)
//   There are two causes. In the second layer a packing at rest has T of 0.004 p along the normal, and p grows with
//   the depth: a force along the wall. And pairs' forces take more than all of T along a lattice's axes. The part along
//   the strain rate alone, everywhere, quenches the roll as well, but the strain rate of single particles is noise, and
//   a vortex gains half as much, a disc's first trough is -0.54 instead of -0.60.
// - Kept for angular momentum's sake: pairs' forces along x_ij. The plain form (<T>_i + <T>_j) grad W_ij does as much.
//
// What was found before, without relief (amplitude of the vortex after 2 s, and of its energy after 1 s):
// - The loss is in proportion to the pressure: 0.77 at 1 m/s^2, 0.13 at 9.81 m/s^2, elastic waves at 100 (cubic
// kernel).
// - It is not numerical: with steps of 0.2 ms and a tolerance of 1e-7 the energy of all particles is conserved
//   within a few per cent, while the vortex loses as much as before; its energy goes into velocities of single
//   particles, which the larger steps and the dissipation then take away. Each particle's density is a constraint, the
//   constraints of neighbours are rough on the scale of a spacing, and smooth flow cannot keep them: so a smoother and
//   wider kernel helps (quintic at 2.7 spacings: 0.58), and solver, tolerance, source, sampling and compressibility
//   (3 % of it) do not.
// - Tried and rejected: a divergence that is exact for linear velocity fields, and its adjoint as the force (the
// strength
//   goes, but no packing is at rest: 0.2 to 0.4 m/s of noise, since the constraint has no potential); taking the
//   error of the pressure force of the smoothed pressure away, in pairs (0.18 instead of 0.08, and
//   twice the iterations; without the pairs it heats); Wendland C2 with 3.2 spacings loses less here, but holds a
//   released sphere more; the cubic kernel with 2.4 to 3 spacings likewise.
// - The same loss damps waves: a standing wave of 30 spacings' depth and steepness 0.16 (flotsam validate
// standing_wave)
//   keeps 0.54 of its amplitude after four periods and 0.17 after ten, with 60 spacings 0.79 after four. It does not
//   depend on the step (4 or 1 ms), the dissipation (2, 0.3, 0), or on how far apart the walls are. Tried:
//   - Hydrostatic pressure below a level under the troughs as an exact force, and SPH's for the rest alone: neighbours'
//     pressures differ by a quarter as much and still water is stiller, but the wave is gone after four periods (0.01).
//     The order that the pressure keeps in the packing carries waves: with less of it, particles rearrange more, and
//     that loses more. With a divergence that is exact for linear fields besides: no noise of 0.2 m/s now, but no less
//     damping either.
//   - Pressures that are SPH averages of the unknowns, and the constraint averaged alike: 0.17 after ten periods as
//     before, with half the pressures' noise again.
//   - Kernels by their Fourier transform, which tells how much a packing's structure changes its densities. What is
//     negative anywhere ((1 - q^2)^n of 2.7 spacings) lets the lattice clump. Wu's positive definite phi_3,1 of 2.7
//     spacings: this vortex keeps 0.60 instead of 0.54, a ball that is let go has a third less drag (bench_release, 5
//     spacings; with 10 its acceleration falls short by 14 % instead of 17), but the wave keeps 0.13, and a disc floats
//     0.15 d higher with the boundary calibration of the quintic. Wendland's C4 of 2.9 and the quintic of 3.4 likewise.
#include "flotsam/world/fluid_world.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

using namespace flotsam;

namespace {

constexpr int kParticles = 40; ///< on an edge
constexpr double kSpacing = 0.02, kEdge = kParticles * kSpacing, kSpeed = 0.3;

Vec3d vortex(const Vec3d& p)
{
    const double x = std::numbers::pi * p.x() / kEdge, z = std::numbers::pi * p.z() / kEdge;
    return kSpeed * Vec3d(std::sin(x) * std::cos(z), 0.0, -std::cos(x) * std::sin(z));
}

struct Motion {
    double amplitude = 0.0; ///< of the vortex in the velocities
    double energy = 0.0;    ///< kinetic, per mass [m^2/s^2]
};

Motion motion_of(const FluidState& fluid)
{
    double along = 0.0, squares = 0.0, energy = 0.0;
    for (std::size_t i = 0; i < fluid.size(); ++i) {
        const Vec3d v = fluid.velocity[i].head<3>().cast<double>();
        const Vec3d mode = vortex(fluid.position[i].head<3>().cast<double>());
        along += v.dot(mode);
        squares += mode.squaredNorm();
        energy += 0.5 * v.squaredNorm();
    }
    return {along / squares, energy / static_cast<double>(fluid.size())};
}

void print_row(const char* name, KernelKind kernel, double gravity, double packing_relief)
{
    FluidWorldSettings settings;
    settings.dimensions = 2;
    settings.particle_spacing = kSpacing;
    settings.gravity = Vec3d(0, 0, -gravity);
    settings.kernel = kernel;
    settings.packing_relief = packing_relief;
    settings.kinematic_viscosity = settings.dissipation = 0.0;
    settings.pressure.solver = PressureSettings::Solver::mprgp;
    FluidWorld world(settings);
    world.add_box_wall({Vec3d::Zero(), Vec3d(kEdge, 1.0, 1.3 * kEdge)}, {"+z"});
    for (int x = 0; x < kParticles; ++x) {
        for (int z = 0; z < kParticles; ++z) {
            const Vec3d at = kSpacing * Vec3d(x + 0.5, 0.0, z + 0.5);
            world.add_particles(std::span<const Vec3d>(&at, 1), vortex(at));
        }
    }
    NoBodies none;
    std::printf("| %s | %g | %g |", name, gravity, packing_relief);
    for (const double until : {0.2, 0.5, 1.0, 2.0}) {
        while (world.time() < until) world.step(world.allowed_time_step(), none);
        const Motion now = motion_of(world.fluid());
        std::printf(" %.3f (%.2f) |", now.amplitude, now.energy / (kSpeed * kSpeed / 4.0));
    }
    std::puts("");
    std::fflush(stdout);
}

} // namespace

int main()
{
    std::puts("| kernel | gravity [m/s^2] | relief | amplitude (kinetic energy) at 0.2 s | 0.5 s | 1 s | 2 s |");
    std::puts("|---|---|---|---|---|---|---|");
    for (const double gravity : {1.0, 9.81, 100.0}) {
        for (const double relief : {0.0, 0.75, 1.0}) {
            print_row("quintic", KernelKind::quintic, gravity, relief);
            print_row("cubic", KernelKind::cubic, gravity, relief);
        }
    }
}
