#include "world/distance_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {

DistanceBounds::DistanceBounds(const SurfaceQuery& surface, double spacing, double band, const Workers& workers)
    : spacing_(spacing), band_(band)
{
    // Far larger surfaces than the particles get a coarser grid rather than more memory than this.
    constexpr double kMaxNodes = 3e7;
    const Aabb box = surface.bounds().inflated(band);
    const double volume = (box.size().array() / spacing_ + 2.0).prod();
    if (volume > kMaxNodes) spacing_ *= std::cbrt(volume / kMaxNodes);
    origin_ = box.min;
    nodes_ = (box.size() / spacing_).array().ceil().cast<int>() + 1;
    distance_.assign(index(0, 0, nodes_.z()), static_cast<float>(band));

    // A node closer than `band` to a triangle lies in the triangle's box widened by it.
    std::vector<char> near(distance_.size(), 0);
    const TriangleMesh& mesh = surface.mesh();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Aabb around;
        for (int k = 0; k < 3; ++k) around.extend(mesh.corner(t, k));
        around = around.inflated(band);
        const Eigen::Vector3i low = ((around.min - origin_) / spacing_).array().floor().cast<int>().max(0);
        const Eigen::Vector3i high =
            ((around.max - origin_) / spacing_).array().ceil().cast<int>().min(nodes_.array() - 1);
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                std::fill(near.begin() + static_cast<std::ptrdiff_t>(index(low.x(), y, z)),
                          near.begin() + static_cast<std::ptrdiff_t>(index(high.x(), y, z)) + 1, char(1));
            }
        }
    }
    std::vector<std::size_t> exact;
    for (std::size_t k = 0; k < near.size(); ++k) {
        if (near[k] != 0) exact.push_back(k);
    }
    workers.for_each(exact.size(), [&](std::size_t k) {
        const std::size_t node = exact[k];
        const std::size_t row = node / static_cast<std::size_t>(nodes_.x());
        const Vec3d at(static_cast<double>(node % static_cast<std::size_t>(nodes_.x())),
                       static_cast<double>(row % static_cast<std::size_t>(nodes_.y())),
                       static_cast<double>(row / static_cast<std::size_t>(nodes_.y())));
        const double found = surface.closest(origin_ + spacing_ * at).distance;
        // Rounded down a little: stored as float.
        distance_[node] = static_cast<float>(std::min(band_, found) - 1e-6 * spacing_);
    });
}

double DistanceBounds::rough_at(const Vec3d& point) const
{
    const Vec3d place = (point - origin_) / spacing_;
    const Vec3d last = nodes_.cast<double>().array() - 1.0;
    if (!((place.array() >= 0.0).all() && (place.array() < last.array()).all())) return band_;
    const Eigen::Vector3i node = (place.array() + 0.5).cast<int>();
    return static_cast<double>(distance_[index(node.x(), node.y(), node.z())]) -
           spacing_ * (place - node.cast<double>()).norm();
}

double DistanceBounds::at(const Vec3d& point) const
{
    const Vec3d place = (point - origin_) / spacing_;
    const Vec3d last = nodes_.cast<double>().array() - 1.0;
    if (!((place.array() >= 0.0).all() && (place.array() < last.array()).all())) return band_;
    const Eigen::Vector3i low = place.cast<int>();
    double bound = 0.0;
    for (int k = 0; k < 8; ++k) {
        const Eigen::Vector3i node(low.x() + (k & 1), low.y() + ((k >> 1) & 1), low.z() + (k >> 2));
        const double away = spacing_ * (place - node.cast<double>()).norm();
        bound = std::max(bound, static_cast<double>(distance_[index(node.x(), node.y(), node.z())]) - away);
    }
    return bound;
}

} // namespace flotsam
