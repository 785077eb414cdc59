#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/geometry/surface_query.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace flotsam {

/// Where samples of a surface are to lie.
struct SurfaceSampleSettings {
    double spacing = 0.0; ///< distance of neighbouring samples [m], > 0
    double inset = 0.0;   ///< depth below the surface on the solid's side [m], >= 0
    int dimensions = 3;   ///< 2: only the outline in the plane y = 0 is sampled
    enum class Solid {
        inside,  ///< the solid is behind the triangles (against their normals): a body
        outside, ///< the solid is in front of them: a container around the water
        both     ///< water on both sides of a sheet; without inset samples lie on it
    } solid = Solid::inside;
    std::uint64_t seed = 1; ///< of the random candidates
};

struct SurfaceSamples {
    std::vector<Vec3d> positions; ///< [m], mesh frame
    std::vector<double> depth;    ///< of each below the surface [m]; < inset where the solid is thin
    double thin_fraction = 0.0;   ///< of the samples that sit in the middle of a part thinner than 2 insets
    /// Of sheets, else empty: unit, from each sample to the face that it stands for, whose water alone may feel it; 0 in
    /// a thin edge, where a sample stands for both faces of its side.
    std::vector<Vec3d> normal;
    std::vector<std::int32_t> side; ///< of sheets, else empty: the face's number
};

/// Blue-noise (Poisson disk) samples of the surface that lies `inset` deep in the solid, one per spacing squared: no
/// two closer than 0.75 spacings, no point of the surface farther than about 0.85 from one. Around bends of more than
/// 180 degrees (the outside of a container) the surface is round; along its sharp edges and at the rims of open sheets
/// samples stand in rows, with one in each corner. Sheets (what has water on both sides, and shells and plates thinner
/// than two insets) have a layer for each side, an inset behind it as behind any face, whatever is there. Where other
/// solids are thinner than two insets they lie in its middle, in one layer. In two dimensions they stand at equal steps along the outline. The same input gives the same samples,
/// whatever `workers`.
/// **Source:** Yuksel 2015 (sample elimination), then repulsion along the surface.
///
/// Throws std::invalid_argument for settings out of range, InputError in two dimensions for a mesh that does not cross
/// the plane y = 0.
[[nodiscard]] SurfaceSamples sample_surface(const SurfaceQuery& surface, const SurfaceSampleSettings& settings,
                                            const Workers& workers = Workers(1));

/// The same, part by part: for large surfaces of which little is needed. The parts are the cells of a grid over the
/// surface's bounds; those at the border have what is beyond. Parts fit together whatever the order in which they are
/// sampled, but the samples near their borders depend on it. Three dimensions only.
class SurfaceSampler {
  public:
    /// `surface` must outlive it; `part_size`: least edge of a part [m], 20 spacings or more. Throws as sample_surface.
    SurfaceSampler(const SurfaceQuery& surface, const SurfaceSampleSettings& settings, double part_size);
    ~SurfaceSampler();
    SurfaceSampler(const SurfaceSampler&) = delete;
    SurfaceSampler& operator=(const SurfaceSampler&) = delete;

    [[nodiscard]] std::size_t parts() const;
    [[nodiscard]] bool is_sampled(std::size_t part) const;
    /// Calls visit for each part whose samples may lie in the box.
    void visit_parts(const Aabb& box, FunctionRef<void(std::size_t part)> visit) const;

    struct Part {
        SurfaceSamples samples;
        /// Within 5 spacings of the part's border, of other parts: also of such as have none yet.
        SurfaceSamples around;
    };
    /// Once for each part.
    [[nodiscard]] Part sample(std::size_t part, const Workers& workers);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotsam
