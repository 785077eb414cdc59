#include "world/fluid_world_impl.hpp"

#include "flotsam/core/contracts.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/triangle_pieces.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

/// Inverse of a symmetric matrix of trace 1 where its eigenvalues are well above 0.1, and 0 where they are well below:
/// a surface that hardly bends takes no force along itself.
Mat3d soft_inverse(const Mat3d& matrix)
{
    Eigen::SelfAdjointEigenSolver<Mat3d> eigen;
    eigen.computeDirect(matrix);
    const Vec3d inverse = eigen.eigenvalues().unaryExpr([](double value) {
        const double cube = value * value * value;
        return cube / (cube * value + 1e-4);
    });
    return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

/// Spreads point forces over a surface as pressures.
class PressureSpread {
  public:
    PressureSpread(const TriangleMesh& mesh, double spacing, double radius, int dimensions)
        : pieces_(pieces_of(mesh, spacing)), grid_(centers(pieces_, dimensions), radius), radius_(radius),
          force_(mesh.triangles.size(), 0.0), area_(mesh.triangles.size(), 0.0)
    {
        for (const TrianglePiece& piece : pieces_) area_[piece.triangle] += piece.area;
    }

    /// `force` at a point of the solid. With w the weights of the parts that it presses on, sum w = 1, part q gets
    /// p A = -w n_q . M^-1 force,  M = sum w n n^T,  so that -sum p A n = force as far as the normals span it.
    void add(const Vec3d& at, const Vec3d& force)
    {
        near_.clear();
        Mat3d spanned = Mat3d::Zero();
        double weights = 0.0;
        grid_.for_near(at, radius_, [&](std::size_t q, double distance_sq) {
            const TrianglePiece& piece = pieces_[q];
            if (!(piece.normal.dot(force) < 0.0)) return; // the far side of a sheet, say
            const double weight = piece.area * std::pow(1.0 - distance_sq / (radius_ * radius_), 3);
            near_.push_back({q, weight});
            spanned += weight * piece.normal * piece.normal.transpose();
            weights += weight;
        });
        if (!(weights > 0.0)) return;
        const Vec3d share = soft_inverse(spanned / weights) * force / weights;
        for (const auto& [q, weight] : near_) force_[pieces_[q].triangle] -= weight * pieces_[q].normal.dot(share);
    }

    /// Pressure times area of each triangle [N].
    [[nodiscard]] std::span<double> forces() { return force_; }

    [[nodiscard]] std::vector<double> pressures(double width) const
    {
        std::vector<double> result(force_.size(), 0.0);
        for (std::size_t t = 0; t < result.size(); ++t)
            if (area_[t] > 0.0) result[t] = width * force_[t] / area_[t];
        return result;
    }

  private:
    static std::vector<Vec3d> centers(std::vector<TrianglePiece>& pieces, int dimensions)
    {
        std::vector<Vec3d> points;
        points.reserve(pieces.size());
        for (TrianglePiece& piece : pieces) {
            if (dimensions == 2) piece.center.y() = 0.0;
            points.push_back(piece.center);
        }
        return points;
    }

    std::vector<TrianglePiece> pieces_;
    PointGrid grid_;
    double radius_;
    std::vector<double> force_, area_; ///< of each triangle
    std::vector<std::pair<std::size_t, double>> near_;
};

} // namespace

std::vector<double> FluidWorld::surface_pressure(int body) const
{
    require(body >= 0 && body < body_count(), "no body has this number", body);
    const Impl& world = *impl_;
    const std::size_t k = static_cast<std::size_t>(body), owner = world.walls.size() + k;
    const TriangleMesh& mesh = world.bodies[k].mesh;
    if (!world.has_pushes(owner)) return std::vector<double>(mesh.triangles.size(), 0.0);
    const int dimensions = world.settings.dimensions;
    PressureSpread spread(mesh, 0.7 * world.spacing(), 2.5 * world.spacing(), dimensions);
    const Quatd to_body = world.states[k].pose.orientation.conjugate();
    // Of each particle the whole force, at the mean place of the samples that it pushes: a particle is on one side of
    // the solid, a sample in a thin part is on both.
    std::uint32_t particle = 0;
    Vec3d force = Vec3d::Zero(), place = Vec3d::Zero();
    double weight = 0.0;
    const auto spread_one = [&] {
        if (weight > 0.0) spread.add(place / weight, to_body * force);
        force = place = Vec3d::Zero();
        weight = 0.0;
    };
    world.visit_pushes(owner, [&](std::uint32_t i, std::uint32_t b, const Vec3d& push) {
        if (i != particle) spread_one();
        particle = i;
        force += push;
        place += push.norm() * world.boundary.position_body[b];
        weight += push.norm();
    });
    spread_one();
    world.films.add_to_triangles(owner, spread.forces());
    return spread.pressures(dimensions == 2 ? bounds(mesh).size().y() : 1.0);
}

} // namespace flotsam
