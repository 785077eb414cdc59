// Whole scenes, those of data/bench: time a step with its spread, shares of the stages, iterations, real-time factor
// and memory, on one thread and two, with the best instruction set and in scalar code; and what its memory gives at
// most, timed in the same run. Half an hour and more. `bench_scenes [SCENE.json ...]` takes other scenes.
// data/bench/results.md is its output.
#include "flotsam/scene/scene_file.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "scene/prepared_scene.hpp"
#include "scene/scene_world.hpp"
#include "sph/simd/instruction_sets.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

using namespace flotsam;

namespace {

constexpr double kGiga = 1e9;

double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Resident memory of this process [bytes].
double resident_memory()
{
    std::ifstream file("/proc/self/statm");
    double pages = 0.0;
    file >> pages >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::string processor()
{
    std::ifstream file("/proc/cpuinfo");
    std::string line;
    while (std::getline(file, line))
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

/// Bytes a second that `threads` threads read and write together: a_i = b_i + c s over arrays far larger than caches.
double stream_rate(int threads)
{
    constexpr std::size_t kItems = std::size_t(1) << 25;
    constexpr int kRounds = 8;
    std::vector<float> a(kItems), b(kItems, 1.0F), c(kItems, 2.0F);
    const Workers workers(threads);
    double best = 0.0;
    for (int round = 0; round < kRounds; ++round) {
        const auto start = std::chrono::steady_clock::now();
        workers.for_chunks(kItems, [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) a[i] = b[i] + 3.0F * c[i];
        });
        best = std::max(best, 3.0 * sizeof(float) * static_cast<double>(kItems) / seconds_since(start));
    }
    return best;
}

struct Row {
    std::vector<double> step_seconds;
    StageSeconds stages; ///< sums
    double products = 0.0, iterations = 0.0, simulated = 0.0, preparation = 0.0, memory = 0.0, neighbours = 0.0;
    std::size_t particles = 0, samples = 0;
};

/// Neighbours of a fluid particle among the fluid, mean.
double mean_neighbours(const FluidWorld& world, const Kernel& kernel)
{
    const FluidState& fluid = world.fluid();
    const Workers workers(1);
    const CellGrid grid =
        CellGrid::around(fluid.position, {}, static_cast<double>(kernel.support()), 16 * fluid.size());
    CellLists lists;
    lists.build(grid, fluid.position, workers);
    SelfPairs pairs;
    NeighbourSearch search;
    kernel.visit([&](const auto& spline) { search.find(spline, grid, lists, fluid.position, workers, pairs); });
    return static_cast<double>(pairs.size()) / static_cast<double>(fluid.size());
}

Row measure(const std::string& file, KernelKind kind, int threads)
{
    const double before = resident_memory();
    SceneFile scene = read_scene(file);
    scene.kernel = kind;
    const scene::PreparedScene prepared = scene::prepare_scene(scene);
    const auto start = std::chrono::steady_clock::now();
    scene::SceneWorld world(scene, prepared, threads);
    const FluidWorld& fluid = world.fluid();
    world.step(fluid.allowed_time_step());
    Row row;
    row.preparation = seconds_since(start);
    row.particles = fluid.fluid().size();
    const bool large = row.particles > 500000;
    const int warm_up = large ? 5 : 40, steps = large ? 6 : 40;
    for (int k = 0; k < warm_up; ++k) world.step(fluid.allowed_time_step());
    for (int k = 0; k < steps; ++k) {
        const auto step_start = std::chrono::steady_clock::now();
        const StepReport report = world.step(fluid.allowed_time_step());
        row.step_seconds.push_back(seconds_since(step_start));
        row.stages.neighbours += report.seconds.neighbours;
        row.stages.density += report.seconds.density;
        row.stages.forces += report.seconds.forces;
        row.stages.pressure += report.seconds.pressure;
        row.stages.advance += report.seconds.advance;
        row.products += static_cast<double>(report.products) / steps;
        row.iterations += static_cast<double>(report.iterations + report.shift_iterations) / steps;
        row.simulated += report.dt;
    }
    row.memory = resident_memory() - before;
    row.samples = fluid.boundary().position.size();
    row.neighbours = mean_neighbours(fluid, Kernel(kind, scene.particle_spacing, scene.dimensions));
    return row;
}

void print(const std::string& name, KernelKind kind, const std::string& set, int threads, Row row)
{
    std::sort(row.step_seconds.begin(), row.step_seconds.end());
    double all = 0.0;
    for (const double s : row.step_seconds) all += s;
    const double count = static_cast<double>(row.step_seconds.size()), n = static_cast<double>(row.particles);
    const auto at = [&](double part) { return 1e3 * row.step_seconds[static_cast<std::size_t>(part * (count - 1.0))]; };
    const auto share = [&](double seconds) { return 100.0 * seconds / all; };
    const double pairs = row.neighbours * n, product = row.stages.pressure / count / std::max(1.0, row.products);
    std::printf(
        "| %s | %zu + %zu | %s | %s | %d | %.1f (%.1f to %.1f) | %.2f | %.0f, %.0f, %.0f, %.0f, %.0f | %.1f, %.1f | "
        "%.1f | %.2f | %.2f | %.2f | %.0f | %.1f |\n",
        name.c_str(), row.particles, row.samples, kind == KernelKind::quintic ? "quintic" : "cubic", set.c_str(),
        threads, at(0.5), at(0.1), at(0.9), 1e6 * all / count / n, share(row.stages.neighbours),
        share(row.stages.density), share(row.stages.forces), share(row.stages.pressure), share(row.stages.advance),
        row.iterations, row.products, 1e3 * row.simulated / count, row.simulated / all, 1e9 * product / pairs,
        2.0 * 4.0 * pairs / product / kGiga, row.memory / n, row.preparation);
    std::fflush(stdout);
}

/// In a process of its own, so that its memory is its own.
bool in_child(const std::string& file, KernelKind kind, const std::string& set, int threads)
{
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        try {
            simd::use_instruction_set(set);
            std::string name = file.substr(file.find_last_of('/') + 1);
            print(name.substr(0, name.rfind(".json")), kind, set, threads, measure(file, kind, threads));
        } catch (const std::exception& error) {
            std::fprintf(stderr, "%s\n", error.what());
            _exit(1);
        }
        _exit(0);
    }
    int status = 0;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

void print_machine()
{
    std::printf("%s, %u threads\n\n", processor().c_str(), std::thread::hardware_concurrency());
    std::puts("| threads | stream a = b + s c [GB/s] |\n|---|---|");
    for (const int threads : {1, 2}) {
        std::fflush(stdout);
        const pid_t child = fork(); // threads started here would not live in the children that come later
        if (child == 0) {
            std::printf("| %d | %.1f |\n", threads, stream_rate(threads) / kGiga);
            std::fflush(stdout);
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
    }
}

} // namespace

int main(int argc, char** argv)
{
    std::vector<std::string> files(argv + 1, argv + argc);
    if (files.empty())
        for (const char* name : {"pool_10k", "deep_tank", "dam_50k", "raft_and_50_boxes", "dam_250k", "dam_1m"})
            files.push_back(std::string(FLOTSAM_BENCH_SCENES "/") + name + ".json");
    const std::vector<std::string> sets = simd::instruction_sets();
    print_machine();
    std::puts(
        "\n| scene | particles + samples | kernel | instruction set | threads | ms a step, median (10 to 90 %) | us a "
        "particle | neighbours, density, forces, pressure, advance [%] | iterations, products | dt [ms] | "
        "real-time factor | ns a pair and product | pairs of a product [GB/s] | bytes a particle | to the first step "
        "[s] |");
    std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    bool fine = true;
    for (const std::string& file : files) {
        const bool large = file.find("1m") != std::string::npos;
        for (const KernelKind kind : {KernelKind::quintic, KernelKind::cubic})
            for (const int threads : {2, 1}) fine = in_child(file, kind, sets.front(), threads) && fine;
        if (!large) fine = in_child(file, KernelKind::quintic, sets.back(), 1) && fine;
    }
    return fine ? 0 : 1;
}
