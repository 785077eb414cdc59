// Compiled several times, once for each instruction set: what stands between HWY_BEFORE_NAMESPACE and
// HWY_AFTER_NAMESPACE is included by foreach_target.h again and again.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128) // nearest kin: scalar, NEON
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sph/pair_passes.cpp" // NOLINT
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "sph/pair_passes.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cstring>

// For lambdas that get registers: called by themselves they would get them through memory.
#undef FLOTSAM_INLINE
#define FLOTSAM_INLINE __attribute__((always_inline))

HWY_BEFORE_NAMESPACE();
namespace flotsam::pair_passes::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes where a register has them, else four, or one without SIMD. Sixteen would leave too many of them empty at
// a row's end.
#if HWY_TARGET == HWY_SCALAR
inline constexpr std::size_t kLanes = 1;
#elif HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON
inline constexpr std::size_t kLanes = 4;
#else
inline constexpr std::size_t kLanes = 8;
#endif
static_assert(kLanes <= Pairs::kSlack && kLanes <= CellLists::kSlack);
using Floats = hn::FixedTag<float, kLanes>;
using Ints = hn::FixedTag<std::uint32_t, kLanes>;
using V = hn::Vec<Floats>;
using U = hn::Vec<Ints>;

struct V3 {
    V x, y, z;
};
struct V4 {
    V x, y, z, w;
};

HWY_INLINE V set(float value)
{
    return hn::Set(Floats(), value);
}

HWY_INLINE const float* at(const Vec4* points, std::uint32_t i)
{
    return reinterpret_cast<const float*>(points + i);
}

/// points[index[0]], points[index[1]], ..., transposed.
HWY_INLINE V4 load_transposed(const Vec4* points, const std::uint32_t* index)
{
#if HWY_TARGET == HWY_SCALAR
    const float* p = at(points, index[0]);
    return {set(p[0]), set(p[1]), set(p[2]), set(p[3])};
#else
    const Floats d;
    const hn::FixedTag<float, 4> four;
    const auto load = [&](int lane) FLOTSAM_INLINE {
        const auto low = hn::Load(four, at(points, index[lane]));
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON
        return low;
#else
        return hn::Combine(d, hn::Load(four, at(points, index[lane + 4])), low);
#endif
    };
    const V a = load(0), b = load(1), c = load(2), e = load(3);
    const hn::RepartitionToWide<Floats> wide;
    const auto ab_low = hn::BitCast(wide, hn::InterleaveLower(d, a, b));
    const auto ab_high = hn::BitCast(wide, hn::InterleaveUpper(d, a, b));
    const auto ce_low = hn::BitCast(wide, hn::InterleaveLower(d, c, e));
    const auto ce_high = hn::BitCast(wide, hn::InterleaveUpper(d, c, e));
    return {hn::BitCast(d, hn::InterleaveLower(wide, ab_low, ce_low)),
            hn::BitCast(d, hn::InterleaveUpper(wide, ab_low, ce_low)),
            hn::BitCast(d, hn::InterleaveLower(wide, ab_high, ce_high)),
            hn::BitCast(d, hn::InterleaveUpper(wide, ab_high, ce_high))};
#endif
}

HWY_INLINE float sum_lanes(V v)
{
    return hn::GetLane(hn::SumOfLanes(Floats(), v));
}

HWY_INLINE V dot(const V3& a, const V3& b)
{
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

template <class A, class B>
HWY_INLINE V3 difference(const A& a, const B& b)
{
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE V4 broadcast(const Vec4& p)
{
    const float* c = reinterpret_cast<const float*>(&p);
    return {set(c[0]), set(c[1]), set(c[2]), set(c[3])};
}

/// Calls visit(k, slope) for each group of pairs of row i, k the first of it; slopes of lanes behind the row's end are
/// 0.
template <class Visit>
HWY_INLINE void for_row(const Pairs& pairs, std::size_t i, Visit&& visit)
{
    const Floats d;
    const float* slope = pairs.slope.data();
    const std::uint32_t last = pairs.start[i + 1];
    std::uint32_t k = pairs.start[i];
    for (; k + kLanes <= last; k += kLanes) visit(k, hn::LoadU(d, slope + k));
    if (k < last) visit(k, hn::IfThenElseZero(hn::FirstN(d, last - k), hn::LoadU(d, slope + k)));
}

HWY_INLINE void store_vec3(const V3& v, Vec4* out)
{
    float* c = reinterpret_cast<float*>(out);
    c[0] = sum_lanes(v.x);
    c[1] = sum_lanes(v.y);
    c[2] = sum_lanes(v.z);
    c[3] = 0;
}

/// For each mask, the lanes that it has, rising, and then any.
constexpr auto kCompressed = [] {
    std::array<std::array<std::int32_t, kLanes>, std::size_t{1} << kLanes> table{};
    for (std::size_t mask = 0; mask < table.size(); ++mask) {
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < kLanes; ++lane)
            if ((mask >> lane & 1) != 0) table[mask][count++] = static_cast<std::int32_t>(lane);
    }
    return table;
}();

// -- search -----------------------------------------------------------------------------------------------------------

/// Ranges of the lists that hold the points of the 3 x 3 x 3 cells around a cell; the cells of a row along x are one.
struct Ranges {
    std::uint32_t first[9], last[9];
    int count = 0;
    std::uint32_t cell = ~std::uint32_t(0);
};

inline void find_ranges(const CellGrid& grid, const CellLists& lists, int hx, int hy, int hz, Ranges& ranges)
{
    const int nx = grid.cells[0], ny = grid.cells[1], nz = grid.cells[2];
    const int low_x = std::max(hx - 1, 0), high_x = std::min(hx + 1, nx - 1);
    ranges.count = 0;
    for (int z = std::max(hz - 1, 0); z <= std::min(hz + 1, nz - 1); ++z) {
        for (int y = std::max(hy - 1, 0); y <= std::min(hy + 1, ny - 1); ++y) {
            const std::size_t row =
                static_cast<std::size_t>(nx) *
                (static_cast<std::size_t>(y) + static_cast<std::size_t>(ny) * static_cast<std::size_t>(z));
            const std::uint32_t first = lists.start[row + static_cast<std::size_t>(low_x)];
            const std::uint32_t last = lists.start[row + static_cast<std::size_t>(high_x) + 1];
            if (first == last) continue;
            ranges.first[ranges.count] = first;
            ranges.last[ranges.count++] = last;
        }
    }
}

/// Calls visit(k, near, r^2) for each group of candidates of point i, k the first of it.
template <class Visit>
HWY_INLINE void for_candidates(const Search& search, std::size_t i, Ranges& ranges, Visit&& visit)
{
    const Floats d;
    const Ints du;
    const CellLists& lists = *search.lists;
    const Eigen::Vector3i home = search.grid->cell_of(search.points[i]);
    const std::uint32_t cell = search.grid->index_of(home);
    if (cell != ranges.cell) {
        find_ranges(*search.grid, lists, home[0], home[1], home[2], ranges);
        ranges.cell = cell;
    }
    const float* own = reinterpret_cast<const float*>(&search.points[i]);
    const V x = set(own[0]), y = set(own[1]), z = set(own[2]);
    const V support_sq = set(search.support * search.support);
    const U self = hn::Set(du, search.same ? static_cast<std::uint32_t>(i) : ~std::uint32_t(0));
    const float *cx = lists.x.data(), *cy = lists.y.data(), *cz = lists.z.data();
    const std::uint32_t* order = lists.order.data();
    for (int r = 0; r < ranges.count; ++r) {
        const std::uint32_t last = ranges.last[r];
        for (std::uint32_t k = ranges.first[r]; k < last; k += kLanes) {
            const V dx = hn::Sub(x, hn::LoadU(d, cx + k));
            const V dy = hn::Sub(y, hn::LoadU(d, cy + k));
            const V dz = hn::Sub(z, hn::LoadU(d, cz + k));
            const V distance_sq = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
            const U index = hn::LoadU(du, order + k);
            auto near = hn::And(hn::Lt(distance_sq, support_sq), hn::RebindMask(d, hn::Ne(index, self)));
            if (k + kLanes > last) near = hn::And(near, hn::FirstN(d, last - k));
            visit(index, near, distance_sq);
        }
    }
}

/// The lanes of v that the mask has, first. Highway's own copies its table to the stack before each use, with GCC 12.
template <class D, class Lanes, class Mask>
HWY_INLINE Lanes compress([[maybe_unused]] D d, Lanes v, Mask mask)
{
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return hn::TableLookupLanes(v, hn::SetTableIndices(d, kCompressed[bits[0]].data()));
#else
    return hn::Compress(v, mask);
#endif
}

void count_neighbours(const Search& search, std::size_t begin, std::size_t end, std::uint32_t* counts)
{
    Ranges ranges;
    for (std::size_t i = begin; i < end; ++i) {
        std::size_t count = 0;
        for_candidates(search, i, ranges,
                       [&](U, auto near, V) FLOTSAM_INLINE { count += hn::CountTrue(Floats(), near); });
        counts[i - begin] = static_cast<std::uint32_t>(count);
    }
}

void write_neighbours(const Search& search, std::size_t begin, std::size_t end, Pairs& pairs)
{
    const Floats d;
    const Ints du;
    Ranges ranges;
    const std::size_t chunk_end = pairs.start[end];
    for (std::size_t i = begin; i < end; ++i) {
        std::size_t k = pairs.start[i];
        for_candidates(search, i, ranges, [&](U index, auto near, V distance_sq) FLOTSAM_INLINE {
            const std::size_t count = hn::CountTrue(d, near);
            const U kept = compress(du, index, hn::RebindMask(du, near));
            const V kept_sq = compress(d, distance_sq, near);
            // Whole registers while what is too much falls into this chunk's rows: those are written later.
            if (k + kLanes <= chunk_end) {
                hn::StoreU(kept, du, pairs.index.data() + k);
                hn::StoreU(kept_sq, d, pairs.slope.data() + k);
            } else {
                HWY_ALIGN std::uint32_t indices[kLanes];
                HWY_ALIGN float squares[kLanes];
                hn::Store(kept, du, indices);
                hn::Store(kept_sq, d, squares);
                std::copy_n(indices, count, pairs.index.begin() + static_cast<std::ptrdiff_t>(k));
                std::copy_n(squares, count, pairs.slope.begin() + static_cast<std::ptrdiff_t>(k));
            }
            k += count;
        });
    }
}

// -- kernels ----------------------------------------------------------------------------------------------------------

HWY_INLINE V pow4(V v)
{
    const V sq = hn::Mul(v, v);
    return hn::Mul(sq, sq);
}

/// The slope and the value of a kernel, as in flotsam/sph/kernel.hpp.
struct Quintic {
    V scale, value_factor, slope_factor;
    explicit Quintic(const QuinticSpline& kernel)
        : scale(set(kernel.scale())), value_factor(set(kernel.factor())),
          slope_factor(set(-5 * kernel.factor() * kernel.scale() * kernel.scale()))
    {
    }
    HWY_INLINE void operator()(V r, V& slope, V& value) const
    {
        const V t = hn::Max(hn::Mul(r, scale), set(1e-4F)), zero = hn::Zero(Floats());
        const V a = hn::Max(hn::Sub(set(3), t), zero);
        const V b = hn::Max(hn::Sub(set(2), t), zero);
        const V c = hn::Max(hn::Sub(set(1), t), zero);
        const V a4 = pow4(a), b4 = hn::Mul(set(-6), pow4(b)), c4 = hn::Mul(set(15), pow4(c));
        slope = hn::Div(hn::Mul(slope_factor, hn::Add(hn::Add(a4, b4), c4)), t);
        value = hn::Mul(value_factor, hn::MulAdd(a4, a, hn::MulAdd(b4, b, hn::Mul(c4, c))));
    }
};

struct Cubic {
    V inv_support, value_factor, slope_factor;
    explicit Cubic(const CubicSpline& kernel)
        : inv_support(set(1 / kernel.support())), value_factor(set(kernel.peak())),
          slope_factor(set(kernel.peak() / (kernel.support() * kernel.support())))
    {
    }
    HWY_INLINE void operator()(V r, V& slope, V& value) const
    {
        const V q = hn::Mul(r, inv_support);
        const V rest = hn::Max(hn::Sub(set(1), q), hn::Zero(Floats()));
        const auto inner = hn::Le(q, set(0.5F));
        const V rest_sq = hn::Mul(rest, rest);
        slope = hn::Mul(slope_factor, hn::IfThenElse(inner, hn::MulAdd(set(18), q, set(-12)),
                                                     hn::Div(hn::Mul(set(-6), rest_sq), hn::Max(q, set(1e-6F)))));
        value = hn::Mul(value_factor,
                        hn::IfThenElse(inner, hn::MulAdd(hn::Mul(hn::Mul(set(6), q), q), hn::Sub(q, set(1)), set(1)),
                                       hn::Mul(hn::Mul(set(2), rest_sq), rest)));
    }
};

template <class Kernel>
HWY_INLINE void evaluate(const Kernel& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                         Pairs& pairs)
{
    const Floats d;
    for (std::size_t i = begin; i < end; ++i) {
        V sum = hn::Zero(d);
        const std::uint32_t last = pairs.start[i + 1];
        for (std::uint32_t k = pairs.start[i]; k < last; k += kLanes) {
            const auto in_row = hn::FirstN(d, last - k);
            V slope, value;
            kernel(hn::Sqrt(hn::IfThenElseZero(in_row, hn::LoadU(d, pairs.slope.data() + k))), slope, value);
            if (!weights.empty()) {
                HWY_ALIGN float weight[kLanes];
                for (std::size_t lane = 0; lane < kLanes; ++lane) weight[lane] = weights[pairs.index[k + lane]];
                value = hn::Mul(value, hn::Load(d, weight));
            }
            sum = hn::Add(sum, hn::IfThenElseZero(in_row, value));
            if (k + kLanes <= last) {
                hn::StoreU(slope, d, pairs.slope.data() + k);
            } else { // what follows are squared distances still, or another thread's
                HWY_ALIGN float slopes[kLanes];
                hn::Store(slope, d, slopes);
                std::copy_n(slopes, last - k, pairs.slope.begin() + k);
            }
        }
        pairs.kernel_sum[i] = sum_lanes(sum);
    }
}

void evaluate_quintic(const QuinticSpline& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                      Pairs& pairs)
{
    evaluate(Quintic(kernel), weights, begin, end, pairs);
}

void evaluate_cubic(const CubicSpline& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                    Pairs& pairs)
{
    evaluate(Cubic(kernel), weights, begin, end, pairs);
}

// -- sums -------------------------------------------------------------------------------------------------------------

void sum_gradients(const Pairs& pairs, const Vec4* points, std::size_t begin, std::size_t end, Vec4* out)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(points[i]);
        V3 sum{zero, zero, zero};
        for_row(pairs, i, [&](std::uint32_t k, V slope) FLOTSAM_INLINE {
            const V4 other = load_transposed(points, pairs.index.data() + k);
            const V3 x = difference(own, other);
            const V factor = hn::Mul(slope, hn::Add(own.w, other.w));
            sum = {hn::MulAdd(factor, x.x, sum.x), hn::MulAdd(factor, x.y, sum.y), hn::MulAdd(factor, x.z, sum.z)};
        });
        store_vec3(sum, out + i);
    }
}

void sum_differences(const Pairs& pairs, const Vec4* position, const Vec4* velocity, std::size_t begin, std::size_t end,
                     Scalar* out)
{
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]), own_v = broadcast(velocity[i]);
        V sum = hn::Zero(Floats());
        for_row(pairs, i, [&](std::uint32_t k, V slope) FLOTSAM_INLINE {
            const V3 x = difference(own, load_transposed(position, pairs.index.data() + k));
            const V3 v = difference(own_v, load_transposed(velocity, pairs.index.data() + k));
            sum = hn::MulAdd(slope, dot(x, v), sum);
        });
        out[i] = sum_lanes(sum);
    }
}

void sum_gradient_squares(const Pairs& pairs, const Vec4* position, std::size_t begin, std::size_t end, Vec4* out)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]);
        V3 sum{zero, zero, zero};
        V squares = zero;
        for_row(pairs, i, [&](std::uint32_t k, V slope) FLOTSAM_INLINE {
            const V3 x = difference(own, load_transposed(position, pairs.index.data() + k));
            sum = {hn::MulAdd(slope, x.x, sum.x), hn::MulAdd(slope, x.y, sum.y), hn::MulAdd(slope, x.z, sum.z)};
            squares = hn::MulAdd(hn::Mul(slope, slope), dot(x, x), squares);
        });
        store_vec3(sum, out + i);
        reinterpret_cast<float*>(out + i)[3] = sum_lanes(squares);
    }
}

void fit_linear(const Pairs& pairs, const Vec4* position, const Vec4* velocity, std::size_t begin, std::size_t end,
                LinearFit* fits)
{
    const V zero = hn::Zero(Floats());
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]), own_v = broadcast(velocity[i]);
        V3 by_x{zero, zero, zero}, by_y = by_x, by_z = by_x, straight = by_x, crossed = by_x;
        for_row(pairs, i, [&](std::uint32_t k, V slope) FLOTSAM_INLINE {
            const V3 x = difference(load_transposed(position, pairs.index.data() + k), own);
            const V3 v = difference(load_transposed(velocity, pairs.index.data() + k), own_v);
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

void sum_viscous_pulls(const Pairs& pairs, const Vec4* position, const Vec4* velocity, const Vec4* strain,
                       const ViscousPull& pull, std::size_t begin, std::size_t end, Vec4* out)
{
    const V zero = hn::Zero(Floats()), soft = set(pull.softening_sq), nu = set(pull.viscosity), width = set(pull.width),
            most = set(pull.most), two = set(2);
    const bool dissipates = pull.width > 0;
    for (std::size_t i = begin; i < end; ++i) {
        const V4 own = broadcast(position[i]), own_v = broadcast(velocity[i]);
        const V4 own_s = dissipates ? broadcast(strain[i]) : V4{zero, zero, zero, zero};
        V3 sum{zero, zero, zero};
        for_row(pairs, i, [&](std::uint32_t k, V slope) FLOTSAM_INLINE {
            const std::uint32_t* index = pairs.index.data() + k;
            const V4 other = load_transposed(position, index), other_v = load_transposed(velocity, index);
            const V3 x = difference(own, other);
            const V s = dot(x, difference(own_v, other_v));
            const V distance_sq = hn::Add(dot(x, x), soft);
            V strength = hn::Mul(nu, s);
            if (dissipates) {
                const V4 other_s = load_transposed(strain, index);
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

} // namespace flotsam::pair_passes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flotsam::pair_passes {

HWY_EXPORT(count_neighbours);
HWY_EXPORT(write_neighbours);
HWY_EXPORT(evaluate_quintic);
HWY_EXPORT(evaluate_cubic);
HWY_EXPORT(sum_gradients);
HWY_EXPORT(sum_differences);
HWY_EXPORT(sum_gradient_squares);
HWY_EXPORT(fit_linear);
HWY_EXPORT(sum_viscous_pulls);

void count_neighbours(const Search& search, std::size_t begin, std::size_t end, std::uint32_t* counts)
{
    HWY_DYNAMIC_DISPATCH(count_neighbours)(search, begin, end, counts);
}

void write_neighbours(const Search& search, std::size_t begin, std::size_t end, Pairs& pairs)
{
    HWY_DYNAMIC_DISPATCH(write_neighbours)(search, begin, end, pairs);
}

void evaluate_kernel(const QuinticSpline& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                     Pairs& pairs)
{
    HWY_DYNAMIC_DISPATCH(evaluate_quintic)(kernel, weights, begin, end, pairs);
}

void evaluate_kernel(const CubicSpline& kernel, std::span<const Scalar> weights, std::size_t begin, std::size_t end,
                     Pairs& pairs)
{
    HWY_DYNAMIC_DISPATCH(evaluate_cubic)(kernel, weights, begin, end, pairs);
}

void sum_gradients(const Pairs& pairs, std::span<const Vec4> at, std::size_t begin, std::size_t end,
                   std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_gradients)(pairs, at.data(), begin, end, out.data());
}

void sum_differences(const Pairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                     std::size_t begin, std::size_t end, std::span<Scalar> out)
{
    HWY_DYNAMIC_DISPATCH(sum_differences)(pairs, position.data(), velocity.data(), begin, end, out.data());
}

void sum_gradient_squares(const Pairs& pairs, std::span<const Vec4> position, std::size_t begin, std::size_t end,
                          std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_gradient_squares)(pairs, position.data(), begin, end, out.data());
}

void fit_linear(const Pairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity, std::size_t begin,
                std::size_t end, LinearFit* fits)
{
    HWY_DYNAMIC_DISPATCH(fit_linear)(pairs, position.data(), velocity.data(), begin, end, fits);
}

void sum_viscous_pulls(const Pairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                       std::span<const Vec4> strain, const ViscousPull& pull, std::size_t begin, std::size_t end,
                       std::span<Vec4> out)
{
    HWY_DYNAMIC_DISPATCH(sum_viscous_pulls)
    (pairs, position.data(), velocity.data(), strain.data(), pull, begin, end, out.data());
}

std::vector<std::string> instruction_sets()
{
    std::vector<std::string> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
    return names;
}

void use_instruction_set(const std::string& name)
{
    std::int64_t mask = 0; // the best
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        if (name == hwy::TargetName(target)) mask = target;
    }
    require(name.empty() || mask != 0, "this processor has no instruction set of that name", 0);
    hwy::SetSupportedTargetsForTest(mask);
    hwy::GetChosenTarget().DeInit(); // the next pass looks again
}

} // namespace flotsam::pair_passes
#endif
