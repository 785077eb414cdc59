#include "support/catch.hpp"

#include "io/mesh_features.hpp" // private: lib/ is on the path of the tests

using namespace flotsam;

namespace {

/// Two unit squares, of two triangles each, that share the edge from (0,0,0) to (0,1,0), bent by `bend` radians.
TriangleMesh folded(double bend)
{
    TriangleMesh mesh;
    mesh.vertices = {{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
    mesh.vertices.emplace_back(std::cos(bend), 0, -std::sin(bend));
    mesh.vertices.emplace_back(std::cos(bend), 1, -std::sin(bend));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
    return mesh;
}

} // namespace

TEST_CASE("normals are shared over flat bends and kept over sharp ones", "[io][picture]")
{
    const auto round = corner_normals(folded(0.2), 35.0);
    const auto sharp = corner_normals(folded(1.0), 35.0);
    REQUIRE(round.size() == 12);
    CHECK(round[0].isApprox(Vec3::UnitZ(), 1e-6f)); // away from the fold
    CHECK(round[1].x() > 0.01f);                    // on it
    CHECK(round[1].norm() == Approx(1.0));
    for (std::size_t k = 0; k < 6; ++k) CHECK(sharp[k].isApprox(Vec3::UnitZ(), 1e-6f));
}

TEST_CASE("feature edges are the sharp and the open ones", "[io][picture]")
{
    CHECK(feature_edges(folded(0.2), 35.0).size() == 6); // the outline
    CHECK(feature_edges(folded(1.0), 35.0).size() == 7); // and the fold
    CHECK(feature_edges({}, 35.0).empty());
}
