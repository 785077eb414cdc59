#include "flotsam/core/contracts.hpp"
#include "flotsam/core/hash.hpp"
#include "support/catch.hpp"

#include <array>
#include <cmath>
#include <limits>

using namespace flotsam;

TEST_CASE("require says what is allowed and what was given", "[core]")
{
    CHECK_NOTHROW(require(true, "a length must be > 0 [m]", 1.0));
    CHECK_THROWS_AS(require(false, "a length must be > 0 [m]", -2.5), std::invalid_argument);
    CHECK_THROWS_WITH(require(false, "a length must be > 0 [m]", -2.5), "a length must be > 0 [m], given -2.5");
    CHECK_THROWS_WITH(require(false, "a mesh needs triangles"), "a mesh needs triangles");
}

TEST_CASE("a condition in its positive form refuses NaN", "[core]")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(require(nan > 0.0, "a length must be > 0 [m]", nan), "a length must be > 0 [m], given nan");
}

TEST_CASE("a state hash is FNV-1a", "[core]")
{
    CHECK(StateHash().value() == 0xcbf29ce484222325ULL);
    StateHash hash; // test vector of the authors
    hash.add_bytes("foobar", 6);
    CHECK(hash.value() == 0x85944171f73967e8ULL);
}

TEST_CASE("a state hash sees every bit, their order, and no borders between pieces", "[core]")
{
    const auto hash_of = [](std::initializer_list<float> values) {
        StateHash hash;
        hash.add(std::span<const float>(values.begin(), values.size()));
        return hash.value();
    };
    const std::uint64_t plain = hash_of({1.0f, 2.0f, 0.0f});
    CHECK(hash_of({1.0f, 2.0f, 0.0f}) == plain);
    CHECK(hash_of({2.0f, 1.0f, 0.0f}) != plain);
    CHECK(hash_of({1.0f, 2.0f, -0.0f}) != plain);
    CHECK(hash_of({1.0f, std::nextafter(2.0f, 3.0f), 0.0f}) != plain);
    StateHash pieces;
    const std::array<float, 3> values = {1.0f, 2.0f, 0.0f};
    for (const float& value : values) pieces.add(std::span<const float>(&value, 1));
    CHECK(pieces.value() == plain);
}
