#include "sph/contacts.hpp"

#include <algorithm>

namespace flotsam {

void ContactBuilder::build(const Pairs& boundary_pairs, std::span<const Vec4> position, const BoundaryState& boundary,
                           std::span<const Vec3d> centers, double rest_density, const Workers& workers,
                           Contacts& contacts)
{
    const std::size_t count = boundary_pairs.rows();
    const std::size_t chunks = Workers::chunk_count(count);
    rows_.resize(std::max(rows_.size(), chunks));
    workers.for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<Row>& rows = rows_[chunk];
        rows.clear();
        if (rows.capacity() == 0) rows.reserve(2 * Workers::kChunk); // two owners for each particle
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t first = rows.size();
            for (std::uint32_t k = boundary_pairs.start[i]; k < boundary_pairs.start[i + 1]; ++k) {
                const std::uint32_t b = boundary_pairs.index[k];
                const std::int32_t owner = boundary.owner[b];
                const Vec3 weight = (static_cast<Scalar>(rest_density) * boundary.volume[b] * boundary_pairs.slope[k]) *
                                    (position[i] - boundary.position[b]).head<3>();
                const Vec3 arm =
                    boundary.position[b].head<3>() - centers[static_cast<std::size_t>(owner)].cast<Scalar>();
                auto row = std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(),
                                        [&](const Row& r) { return r.owner == owner; });
                if (row == rows.end()) {
                    rows.push_back({owner, static_cast<std::uint32_t>(i), Vec6::Zero()});
                    row = rows.end() - 1;
                }
                row->row.head<3>() += weight;
                row->row.tail<3>() += arm.cross(weight);
            }
        }
    });
    // Counting sort by owner; chunks come in order, so particles rise within an owner.
    contacts.start.assign(centers.size() + 1, 0);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (const Row& row : rows_[chunk]) ++contacts.start[static_cast<std::size_t>(row.owner) + 1];
    }
    for (std::size_t k = 1; k < contacts.start.size(); ++k) contacts.start[k] += contacts.start[k - 1];
    const std::size_t total = contacts.start.back();
    if (contacts.row.capacity() < total) {
        contacts.row.reserve(total + total / 2);
        contacts.particle.reserve(total + total / 2);
    }
    contacts.row.resize(total);
    contacts.particle.resize(total);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        for (const Row& row : rows_[chunk]) {
            const std::uint32_t slot = contacts.start[static_cast<std::size_t>(row.owner)]++;
            contacts.row[slot] = row.row;
            contacts.particle[slot] = row.particle;
        }
    }
    std::copy_backward(contacts.start.begin(), contacts.start.end() - 1, contacts.start.end());
    contacts.start[0] = 0;
}

} // namespace flotsam
