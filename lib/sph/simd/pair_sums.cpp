// Compiled once for each instruction set: foreach_target.h includes this file again and again.
#include "sph/simd/targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sph/simd/pair_sums.cpp" // NOLINT
#include <hwy/foreach_target.h>

#include "sph/simd/lanes.hpp"
#include "sph/simd/pair_sums.hpp"

HWY_BEFORE_NAMESPACE();
namespace flotsam::simd::HWY_NAMESPACE {

void sum_gradients(const SelfPairs& pairs, const Vec4* points, std::size_t begin, std::size_t end, Vec4* out)
{
    for (std::size_t i = begin; i < end; ++i) {
        GradientSum sum(points[i]);
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE { sum.add(points, neighbours, slope); });
        sum.store(out + i);
    }
}

void sum_divergences(const SelfPairs& pairs, const Vec4* position, const Vec4* velocity, std::size_t begin,
                     std::size_t end, Scalar* out)
{
    for (std::size_t i = begin; i < end; ++i) {
        DivergenceSum sum(position[i]);
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            sum.add(position, velocity, neighbours, slope);
        });
        out[i - begin] = sum.total();
    }
}

void sum_gradient_squares(const SelfPairs& pairs, const Vec4* position, std::size_t begin, std::size_t end, Vec4* out)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]);
        V3 sum{zero, zero, zero};
        V squares = zero;
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            const V3 x = difference(own, load_transposed(position, neighbours));
            sum = {hn::MulAdd(slope, x.x, sum.x), hn::MulAdd(slope, x.y, sum.y), hn::MulAdd(slope, x.z, sum.z)};
            squares = hn::MulAdd(hn::Mul(slope, slope), dot(x, x), squares);
        });
        store_vec3(sum, out + i);
        reinterpret_cast<float*>(out + i)[3] = sum_lanes(squares);
    }
}

void fit_linear(const SelfPairs& pairs, const Vec4* position, const Vec4* velocity, std::size_t begin, std::size_t end,
                LinearFit* fits)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]), own_v = broadcast(velocity[i]);
        V3 by_x{zero, zero, zero}, by_y = by_x, by_z = by_x, straight = by_x, crossed = by_x;
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            const V3 x = difference(load_transposed(position, neighbours), own);
            const V3 v = difference(load_transposed(velocity, neighbours), own_v);
            // grad W_ij = slope (x_i - x_j) = -slope x
            const V gx = hn::Neg(hn::Mul(slope, x.x)), gy = hn::Neg(hn::Mul(slope, x.y)),
                    gz = hn::Neg(hn::Mul(slope, x.z));
            by_x = {hn::MulAdd(gx, v.x, by_x.x), hn::MulAdd(gx, v.y, by_x.y), hn::MulAdd(gx, v.z, by_x.z)};
            by_y = {hn::MulAdd(gy, v.x, by_y.x), hn::MulAdd(gy, v.y, by_y.y), hn::MulAdd(gy, v.z, by_y.z)};
            by_z = {hn::MulAdd(gz, v.x, by_z.x), hn::MulAdd(gz, v.y, by_z.y), hn::MulAdd(gz, v.z, by_z.z)};
            straight = {hn::MulAdd(gx, x.x, straight.x), hn::MulAdd(gy, x.y, straight.y),
                        hn::MulAdd(gz, x.z, straight.z)};
            crossed = {hn::MulAdd(gx, x.y, crossed.x), hn::MulAdd(gx, x.z, crossed.y), hn::MulAdd(gy, x.z, crossed.z)};
        });
        LinearFit& fit = fits[i - begin];
        fit.velocity = {sum_lanes(by_x.x), sum_lanes(by_y.x), sum_lanes(by_z.x), sum_lanes(by_x.y), sum_lanes(by_y.y),
                        sum_lanes(by_z.y), sum_lanes(by_x.z), sum_lanes(by_y.z), sum_lanes(by_z.z)};
        fit.shape = {sum_lanes(straight.x), sum_lanes(straight.y), sum_lanes(straight.z),
                     sum_lanes(crossed.x),  sum_lanes(crossed.y),  sum_lanes(crossed.z)};
    }
}

void sum_viscous_pulls(const SelfPairs& pairs, const Vec4* position, const Vec4* velocity, const Vec4* strain,
                       const ViscousPull& pull, std::size_t begin, std::size_t end, Vec4* out)
{
    const V zero = hn::Zero(Floats()), soft = set(pull.softening_sq), nu = set(pull.viscosity), width = set(pull.width),
            most = set(pull.most), two = set(2);
    const bool dissipates = pull.width > 0;
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]), own_v = broadcast(velocity[i]);
        const V4 own_s = dissipates ? broadcast(strain[i]) : V4{zero, zero, zero, zero};
        V3 sum{zero, zero, zero};
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            const V4 other = load_transposed(position, neighbours), other_v = load_transposed(velocity, neighbours);
            const V3 x = difference(own, other);
            const V s = dot(x, difference(own_v, other_v));
            const V distance_sq = hn::Add(dot(x, x), soft);
            V strength = hn::Mul(nu, s);
            if (dissipates) {
                const V4 other_s = load_transposed(strain, neighbours);
                const V3 straight{hn::Add(own.w, other.w), hn::Add(own_v.w, other_v.w), hn::Add(own_s.x, other_s.x)};
                const V xy = hn::Add(own_s.y, other_s.y), xz = hn::Add(own_s.z, other_s.z),
                        yz = hn::Add(own_s.w, other_s.w);
                const V crossed = hn::MulAdd(hn::Mul(x.x, x.y), xy,
                                             hn::MulAdd(hn::Mul(x.x, x.z), xz, hn::Mul(hn::Mul(x.y, x.z), yz)));
                const V linear =
                    hn::MulAdd(two, crossed, dot({hn::Mul(x.x, x.x), hn::Mul(x.y, x.y), hn::Mul(x.z, x.z)}, straight));
                const V q = hn::Clamp(hn::Sub(s, linear), hn::Min(s, zero), hn::Max(s, zero));
                const V viscosity = hn::Min(most, hn::Div(hn::Mul(width, hn::Abs(q)), hn::Sqrt(distance_sq)));
                strength = hn::MulAdd(viscosity, q, strength);
            }
            const V factor = hn::Mul(slope, hn::Div(strength, distance_sq));
            sum = {hn::MulAdd(factor, x.x, sum.x), hn::MulAdd(factor, x.y, sum.y), hn::MulAdd(factor, x.z, sum.z)};
        });
        store_vec3(sum, out + i);
    }
}

void sum_virials(const SelfPairs& pairs, const Vec4* points, std::size_t begin, std::size_t end,
                 std::array<Scalar, 6>* out)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(points[i]);
        V3 straight{zero, zero, zero}, crossed = straight;
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            const V4 other = load_transposed(points, neighbours);
            const V3 x = difference(own, other);
            const V factor = hn::Mul(slope, hn::Add(own.w, other.w));
            const V fx = hn::Mul(factor, x.x), fy = hn::Mul(factor, x.y);
            straight = {hn::MulAdd(fx, x.x, straight.x), hn::MulAdd(fy, x.y, straight.y),
                        hn::MulAdd(hn::Mul(factor, x.z), x.z, straight.z)};
            crossed = {hn::MulAdd(fx, x.y, crossed.x), hn::MulAdd(fx, x.z, crossed.y), hn::MulAdd(fy, x.z, crossed.z)};
        });
        out[i - begin] = {sum_lanes(straight.x), sum_lanes(straight.y), sum_lanes(straight.z),
                          sum_lanes(crossed.x),  sum_lanes(crossed.y),  sum_lanes(crossed.z)};
    }
}

void smooth_deviators(const SelfPairs& pairs, const Vec4* at, const Vec4* rest, std::size_t begin, std::size_t end,
                      Vec4* out_at, Vec4* out_rest)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(at[i]);
        V weights = zero, xx = zero;
        V4 sum{zero, zero, zero, zero};
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            const V4 other = load_transposed(at, neighbours);
            const V4 tensor = load_transposed(rest, neighbours);
            const V3 x = difference(own, other);
            const V weight = hn::Mul(slope, dot(x, x));
            weights = hn::Add(weights, weight);
            xx = hn::MulAdd(weight, other.w, xx);
            sum = {hn::MulAdd(weight, tensor.x, sum.x), hn::MulAdd(weight, tensor.y, sum.y),
                   hn::MulAdd(weight, tensor.z, sum.z), hn::MulAdd(weight, tensor.w, sum.w)};
        });
        const float total = sum_lanes(weights), inverse = total < 0 ? 1 / total : 0;
        float* c = reinterpret_cast<float*>(out_at + i);
        const float* p = reinterpret_cast<const float*>(at + i);
        c[0] = p[0], c[1] = p[1], c[2] = p[2];
        c[3] = inverse * sum_lanes(xx);
        c = reinterpret_cast<float*>(out_rest + i);
        c[0] = inverse * sum_lanes(sum.x), c[1] = inverse * sum_lanes(sum.y);
        c[2] = inverse * sum_lanes(sum.z), c[3] = inverse * sum_lanes(sum.w);
    }
}

void sum_deviator_pushes(const SelfPairs& pairs, const Vec4* at, const Vec4* rest, std::size_t begin, std::size_t end,
                         Vec4* out)
{
    const V zero = hn::Zero(Floats()), two = set(2), least = set(1e-30F);
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(at[i]), own_t = broadcast(rest[i]);
        V3 sum{zero, zero, zero};
        for_row(pairs, i, [&](const auto& neighbours, V slope) FLOTSAM_INLINE {
            const V4 other = load_transposed(at, neighbours);
            const V4 other_t = load_transposed(rest, neighbours);
            const V3 x = difference(own, other);
            const V xx = hn::Add(own.w, other.w), yy = hn::Add(own_t.x, other_t.x);
            const V xy = hn::Add(own_t.y, other_t.y), xz = hn::Add(own_t.z, other_t.z),
                    yz = hn::Add(own_t.w, other_t.w);
            const V crossed =
                hn::MulAdd(hn::Mul(x.x, x.y), xy, hn::MulAdd(hn::Mul(x.x, x.z), xz, hn::Mul(hn::Mul(x.y, x.z), yz)));
            const V3 squares{hn::Mul(x.x, x.x), hn::Mul(x.y, x.y), hn::Mul(x.z, x.z)};
            const V along = hn::MulAdd(two, crossed, dot(squares, V3{xx, yy, hn::Neg(hn::Add(xx, yy))}));
            const V distance_sq = hn::Max(hn::Add(squares.x, hn::Add(squares.y, squares.z)), least);
            const V factor = hn::Mul(slope, hn::Div(along, distance_sq));
            sum = {hn::MulAdd(factor, x.x, sum.x), hn::MulAdd(factor, x.y, sum.y), hn::MulAdd(factor, x.z, sum.z)};
        });
        store_vec3(sum, out + i);
    }
}

} // namespace flotsam::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flotsam::simd {

HWY_EXPORT(sum_gradients);
HWY_EXPORT(sum_divergences);
HWY_EXPORT(sum_gradient_squares);
HWY_EXPORT(fit_linear);
HWY_EXPORT(sum_viscous_pulls);
HWY_EXPORT(sum_virials);
HWY_EXPORT(smooth_deviators);
HWY_EXPORT(sum_deviator_pushes);

void sum_gradients(const SelfPairs& pairs, std::span<const Vec4> at, std::size_t begin, std::size_t end,
                   std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_gradients)(pairs, at.data(), begin, end, out.data());
}

void sum_divergences(const SelfPairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                     std::size_t begin, std::size_t end, std::span<Scalar> out)
{
    HWY_DYNAMIC_DISPATCH(sum_divergences)(pairs, position.data(), velocity.data(), begin, end, out.data());
}

void sum_gradient_squares(const SelfPairs& pairs, std::span<const Vec4> position, std::size_t begin, std::size_t end,
                          std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_gradient_squares)(pairs, position.data(), begin, end, out.data());
}

void fit_linear(const SelfPairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                std::size_t begin, std::size_t end, LinearFit* fits)
{
    HWY_DYNAMIC_DISPATCH(fit_linear)(pairs, position.data(), velocity.data(), begin, end, fits);
}

void sum_viscous_pulls(const SelfPairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                       std::span<const Vec4> strain, const ViscousPull& pull, std::size_t begin, std::size_t end,
                       std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_viscous_pulls)
    (pairs, position.data(), velocity.data(), strain.data(), pull, begin, end, out.data());
}

void sum_virials(const SelfPairs& pairs, std::span<const Vec4> at, std::size_t begin, std::size_t end,
                 std::array<Scalar, 6>* out)
{
    HWY_DYNAMIC_DISPATCH(sum_virials)(pairs, at.data(), begin, end, out);
}

void smooth_deviators(const SelfPairs& pairs, std::span<const Vec4> at, std::span<const Vec4> rest, std::size_t begin,
                      std::size_t end, std::span<Vec4> out_at, std::span<Vec4> out_rest)
{
    HWY_DYNAMIC_DISPATCH(smooth_deviators)
    (pairs, at.data(), rest.data(), begin, end, out_at.data(), out_rest.data());
}

void sum_deviator_pushes(const SelfPairs& pairs, std::span<const Vec4> at, std::span<const Vec4> rest,
                         std::size_t begin, std::size_t end, std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_deviator_pushes)(pairs, at.data(), rest.data(), begin, end, out.data());
}

} // namespace flotsam::simd
#endif
