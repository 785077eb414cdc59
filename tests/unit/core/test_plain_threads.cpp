#include "core/plain_threads.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <stdexcept>

using namespace flotsam;

TEST_CASE("plain threads run every chunk once, loop after loop", "[core]")
{
    const int threads = GENERATE(1, 2, 3);
    PlainThreads team(threads);
    std::vector<int> visits(100, 0);
    for (std::size_t chunks : {0u, 1u, 2u, 100u}) team.run(chunks, [&](std::size_t chunk) { ++visits[chunk]; });
    CHECK(visits[0] == 3);
    CHECK(visits[1] == 2);
    CHECK(std::count(visits.begin() + 2, visits.end(), 1) == 98);
}

TEST_CASE("plain threads: a loop inside a loop is done too", "[core]")
{
    PlainThreads team(2);
    std::vector<int> visits(64, 0);
    team.run(8, [&](std::size_t outer) { team.run(8, [&](std::size_t inner) { ++visits[8 * outer + inner]; }); });
    CHECK(std::count(visits.begin(), visits.end(), 1) == 64);
}

TEST_CASE("plain threads hand an exception to the caller and go on", "[core]")
{
    PlainThreads team(3);
    CHECK_THROWS_AS(team.run(10, [](std::size_t) { throw std::runtime_error("chunk"); }), std::runtime_error);
    std::atomic<int> visits = 0;
    team.run(10, [&](std::size_t) { ++visits; });
    CHECK(visits == 10);
}
