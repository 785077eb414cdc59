#include "flotsam/core/parallel.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

using namespace flotsam;

namespace {

int call(FunctionRef<int(int)> function, int argument)
{
    return function(argument);
}

} // namespace

TEST_CASE("a FunctionRef calls what it was given", "[core]")
{
    int calls = 0;
    const auto counting = [&](int x) { return ++calls + x; };
    CHECK(call(counting, 10) == 11);
    CHECK(call(counting, 10) == 12); // the same object, not a copy
    CHECK(call([](int x) { return -x; }, 3) == -3);
    CHECK(sizeof(FunctionRef<int(int)>) == 2 * sizeof(void*));
}

TEST_CASE("a FunctionRef passes references and what cannot be copied", "[core]")
{
    const auto append = [](std::string& text, std::unique_ptr<int> number) { text += std::to_string(*number); };
    const FunctionRef<void(std::string&, std::unique_ptr<int>)> reference = append;
    std::string text = "n";
    reference(text, std::make_unique<int>(7));
    CHECK(text == "n7");
}

TEST_CASE("chunks cover a loop once, with the same borders for any number of threads", "[core]")
{
    const int threads = GENERATE(1, 2, 3);
    const std::size_t items = GENERATE(0u, 1u, 255u, 256u, 257u, 10000u);
    const Workers workers(threads);
    CHECK(workers.threads() == threads);
    std::vector<int> visits(items, 0);
    std::vector<std::pair<std::size_t, std::size_t>> borders(Workers::chunk_count(items));
    workers.for_chunks(items, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        borders.at(chunk) = {begin, end};
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    CHECK(std::count(visits.begin(), visits.end(), 1) == static_cast<std::ptrdiff_t>(items));
    for (std::size_t chunk = 0; chunk < borders.size(); ++chunk) {
        CHECK(borders[chunk].first == chunk * Workers::kChunk);
        CHECK(borders[chunk].second == std::min(items, (chunk + 1) * Workers::kChunk));
    }
}

TEST_CASE("ordered sums have the same bits for any number of threads", "[core]")
{
    const auto term = [](std::size_t i) { return std::sin(0.1 * static_cast<double>(i * i)) * 1e3; };
    const auto sum = [&](int threads) {
        std::vector<double> scratch;
        return Workers(threads).ordered_sum<double>(100000, scratch, term);
    };
    const double one = sum(1);
    CHECK(sum(2) == one);
    CHECK(sum(3) == one);
    double plain = 0.0;
    for (std::size_t i = 0; i < 100000; ++i) plain += term(i);
    CHECK(one == Approx(plain).epsilon(1e-9)); // another order of 1e5 additions in double
}

TEST_CASE("an ordered sum over nothing is zero", "[core]")
{
    std::vector<double> scratch(3, 1.0);
    CHECK(Workers(2).ordered_sum<double>(0, scratch, [](std::size_t) { return 1.0; }) == 0.0);
}

TEST_CASE("a loop hands its exception to the caller", "[core]")
{
    const Workers workers(GENERATE(1, 2));
    CHECK_THROWS_AS(workers.for_each(1000,
                                     [](std::size_t i) {
                                         if (i == 700) throw std::runtime_error("item 700");
                                     }),
                    std::runtime_error);
}

TEST_CASE("as many threads work as were asked for, on a machine with fewer cores too", "[core]")
{
    const std::size_t threads = std::thread::hardware_concurrency() + 1;
    const Workers workers(static_cast<int>(threads));
    std::mutex mutex;
    std::set<std::thread::id> seen;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    workers.for_each(64 * threads * Workers::kChunk, [&](std::size_t i) {
        if (i % Workers::kChunk != 0) return;
        const auto all_are_here = [&] {
            const std::lock_guard lock(mutex);
            seen.insert(std::this_thread::get_id());
            return seen.size() >= threads;
        };
        while (!all_are_here() && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
    });
    CHECK(seen.size() == threads);
}

TEST_CASE("workers refuse a number of threads that is none", "[core]")
{
    CHECK_THROWS_AS(Workers(-1), std::invalid_argument);
    CHECK_THROWS_AS(Workers(1025), std::invalid_argument);
    CHECK(Workers(0).threads() >= 1);
}
