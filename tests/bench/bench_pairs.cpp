// The loops over pairs by themselves: for each instruction set that the processor has, one thread and two. `pairs` a
// second count pairs, `points` a second points; the water is a jittered cubic lattice in the order of its cells.
#include "flotsam/sph/neighbourhood.hpp"
#include "sph/simd/instruction_sets.hpp"
#include "sph/simd/pair_sums.hpp"

#include <benchmark/benchmark.h>

#include <random>

using namespace flotsam;

namespace {

constexpr double kSpacing = 0.02;

struct Water {
    Workers workers;
    std::vector<Vec4> position, velocity, strain, at;
    CellGrid grid;
    CellLists lists;
    SelfPairs pairs;
    Kernel kernel;
    NeighbourSearch search;

    Water(int side, KernelKind kind, int threads) : workers(threads), kernel(kind, kSpacing, 3)
    {
        std::mt19937 random(1);
        std::normal_distribution<double> jitter(0.0, 0.15);
        for (int x = 0; x < side; ++x)
            for (int y = 0; y < side; ++y)
                for (int z = 0; z < side; ++z) {
                    const Vec3d p(x + jitter(random), y + jitter(random), z + jitter(random));
                    position.emplace_back(Vec4::Zero());
                    position.back().head<3>() = (kSpacing * p).cast<Scalar>();
                }
        sort();
        const std::vector<Vec4> shuffled = position;
        for (std::size_t i = 0; i < position.size(); ++i) position[i] = shuffled[lists.order[i]];
        sort();
        find();
        velocity = position;
        strain = position;
        at = position;
    }
    void sort()
    {
        grid = CellGrid::around(position, {}, static_cast<double>(kernel.support()), 16 * position.size());
        lists.build(grid, position, workers);
    }
    void find()
    {
        kernel.visit([&](const auto& spline) { search.find(spline, grid, lists, position, workers, pairs); });
    }
};

/// Runs `pass(water)` with the instruction set and the threads of a benchmark.
template <class Pass>
void run(benchmark::State& state, const std::string& set, int threads, int side, KernelKind kind, Pass&& pass)
{
    simd::use_instruction_set(set);
    Water water(side, kind, threads);
    for (auto _ : state) pass(water);
    const double each = static_cast<double>(state.iterations());
    state.counters["pairs"] =
        benchmark::Counter(each * static_cast<double>(water.pairs.size()), benchmark::Counter::kIsRate);
    state.counters["points"] =
        benchmark::Counter(each * static_cast<double>(water.position.size()), benchmark::Counter::kIsRate);
    state.counters["neighbours"] = static_cast<double>(water.pairs.size()) / static_cast<double>(water.position.size());
    simd::use_instruction_set("");
}

void add(const std::string& name, int side, void (*pass)(Water&))
{
    for (const KernelKind kind : {KernelKind::quintic, KernelKind::cubic})
        for (const std::string& set : simd::instruction_sets())
            for (const int threads : {1, 2}) {
                const std::string full = name + (kind == KernelKind::quintic ? "/quintic/" : "/cubic/") + set +
                                         "/threads:" + std::to_string(threads);
                benchmark::RegisterBenchmark(
                    full.c_str(), [=](benchmark::State& state) { run(state, set, threads, side, kind, pass); })
                    ->UseRealTime()
                    ->Unit(benchmark::kMillisecond);
            }
}

template <class Pass>
void in_chunks(Water& water, Pass&& pass)
{
    water.workers.for_chunks(water.position.size(),
                             [&](std::size_t, std::size_t begin, std::size_t end) { pass(begin, end); });
}

} // namespace

int main(int argc, char** argv)
{
    add("sort and search", 100, [](Water& w) {
        w.sort();
        w.find();
    });
    add("sum_gradients", 40, [](Water& w) {
        in_chunks(w, [&](auto begin, auto end) { simd::sum_gradients(w.pairs, w.at, begin, end, w.strain); });
    });
    add("sum_divergences", 40, [](Water& w) {
        static std::vector<Scalar> out;
        out.resize(w.position.size());
        in_chunks(w, [&](auto begin, auto end) {
            simd::sum_divergences(w.pairs, w.position, w.velocity, begin, end, std::span(out).subspan(begin));
        });
    });
    add("fit_linear", 40, [](Water& w) {
        in_chunks(w, [&](auto begin, auto end) {
            std::array<simd::LinearFit, Workers::kChunk> fits;
            simd::fit_linear(w.pairs, w.position, w.velocity, begin, end, fits.data());
            benchmark::DoNotOptimize(fits);
        });
    });
    add("sum_viscous_pulls", 40, [](Water& w) {
        const simd::ViscousPull pull{Scalar(1e-6), Scalar(1e-3), Scalar(1), Scalar(1e-6)};
        in_chunks(w, [&](auto begin, auto end) {
            simd::sum_viscous_pulls(w.pairs, w.position, w.velocity, w.position, pull, begin, end, w.strain);
        });
    });
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
}
