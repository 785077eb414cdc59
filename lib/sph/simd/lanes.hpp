// Registers of particles, for the loops over pairs. Included once for each instruction set (Highway), inside
// foreach_target.h; the guard lets it in again for the next one.
#if defined(FLOTSAM_SPH_SIMD_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FLOTSAM_SPH_SIMD_LANES_HPP
#undef FLOTSAM_SPH_SIMD_LANES_HPP
#else
#define FLOTSAM_SPH_SIMD_LANES_HPP
#endif

#include "flotsam/sph/cell_grid.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <hwy/highway.h>

#include <cstdint>

// For lambdas that get registers: called by themselves they would get them through memory.
#undef FLOTSAM_INLINE
#define FLOTSAM_INLINE __attribute__((always_inline))

HWY_BEFORE_NAMESPACE();
namespace flotsam::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes where a register has them, else four, or one without SIMD. Sixteen would leave too many of them empty at
// a row's end.
#if HWY_TARGET == HWY_SCALAR
inline constexpr std::size_t kLanes = 1;
#elif HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON || HWY_TARGET == HWY_EMU128
inline constexpr std::size_t kLanes = 4;
#else
inline constexpr std::size_t kLanes = 8;
#endif
static_assert(kLanes <= Pairs::kSlack && kLanes <= SelfPairs::kSlack && kLanes <= CellLists::kSlack);
using Floats = hn::FixedTag<float, kLanes>;
using Ints = hn::FixedTag<std::uint32_t, kLanes>;
using SignedInts = hn::FixedTag<std::int32_t, kLanes>;
using Shorts = hn::FixedTag<std::int16_t, kLanes>;
using UnsignedShorts = hn::FixedTag<std::uint16_t, kLanes>;
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

/// Neighbours of a row, one for each lane, by their numbers.
struct FarNeighbours {
    const std::uint32_t* index;
    HWY_INLINE const float* of(const Vec4* points, int lane) const { return at(points, index[lane]); }
};
/// The same by their distance from the row's own number.
struct NearNeighbours {
    std::size_t own;
    const std::int16_t* offset;
    HWY_INLINE const float* of(const Vec4* points, int lane) const
    {
        return reinterpret_cast<const float*>(points + own + static_cast<std::ptrdiff_t>(offset[lane]));
    }
};

#if HWY_TARGET != HWY_SCALAR
/// The points of pair `lane` (0 to 3) in four lanes, and of the pair four lanes on in the other four.
template <class Neighbours>
HWY_INLINE V load_points(const Vec4* points, const Neighbours& neighbours, int lane)
{
    const hn::FixedTag<float, 4> four;
    const auto low = hn::Load(four, neighbours.of(points, lane));
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON || HWY_TARGET == HWY_EMU128
    return low;
#else
    return hn::Combine(Floats(), hn::Load(four, neighbours.of(points, lane + 4)), low);
#endif
}
#endif

/// The points that the lanes' neighbours are, transposed.
template <class Neighbours>
HWY_INLINE V4 load_transposed(const Vec4* points, const Neighbours& neighbours)
{
#if HWY_TARGET == HWY_SCALAR
    const float* p = neighbours.of(points, 0);
    return {set(p[0]), set(p[1]), set(p[2]), set(p[3])};
#else
    const Floats d;
    const V a = load_points(points, neighbours, 0), b = load_points(points, neighbours, 1),
            c = load_points(points, neighbours, 2), e = load_points(points, neighbours, 3);
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

template <class B>
HWY_INLINE V dot(const V3& a, const B& b)
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

/// Calls visit(neighbours, slope) for each group of pairs of row i. Lanes without a pair of their own have slope 0 and
/// some point for a neighbour.
template <class Visit>
HWY_INLINE void for_row(const SelfPairs& pairs, std::size_t i, Visit&& visit)
{
    const Floats d;
    const Shorts shorts;
    const V unit = set(pairs.unit);
    const std::uint32_t first = pairs.start[i], last = pairs.start[i + 1];
    const std::uint16_t* parts = pairs.parts.data();
    const auto slope_at = [&](std::uint32_t k) FLOTSAM_INLINE {
        return hn::Mul(unit, hn::ConvertTo(d, hn::PromoteTo(SignedInts(), hn::LoadU(UnsignedShorts(), parts + k))));
    };
    std::uint32_t k = first;
    if (pairs.is_far()) {
        const std::uint32_t* index = pairs.index.data();
        for (; k + kLanes <= last; k += kLanes) visit(FarNeighbours{index + k}, slope_at(k));
        if (k < last) visit(FarNeighbours{index + k}, hn::IfThenElseZero(hn::FirstN(d, last - k), slope_at(k)));
        return;
    }
    // What follows the row are offsets from other points: its end is taken with what is before it, or by itself.
    const std::int16_t* offset = pairs.offset.data();
    for (; k + kLanes <= last; k += kLanes) visit(NearNeighbours{i, offset + k}, slope_at(k));
    if (k == last) return;
    if (first + kLanes <= last) {
        const std::uint32_t from = last - static_cast<std::uint32_t>(kLanes);
        visit(NearNeighbours{i, offset + from}, hn::IfThenZeroElse(hn::FirstN(d, k - from), slope_at(from)));
        return;
    }
    HWY_ALIGN std::int16_t rest[kLanes];
    hn::Store(hn::IfThenElseZero(hn::FirstN(shorts, last - k), hn::LoadU(shorts, offset + k)), shorts, rest);
    visit(NearNeighbours{i, rest}, hn::IfThenElseZero(hn::FirstN(d, last - k), slope_at(k)));
}

/// sum_j slope_j w_j (x_i - x_j), without transposing: it needs no more than products of whole points.
class GradientSum {
  public:
#if HWY_TARGET == HWY_SCALAR
    HWY_INLINE explicit GradientSum(const Vec4& point)
        : own_(broadcast(point)), sum_{hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats())}
    {
    }
    template <class Neighbours>
    HWY_INLINE void add(const Vec4* points, const Neighbours& neighbours, V slope)
    {
        const V4 other = load_transposed(points, neighbours);
        const V3 x = difference(own_, other);
        const V factor = hn::Mul(slope, other.w);
        sum_ = {hn::MulAdd(factor, x.x, sum_.x), hn::MulAdd(factor, x.y, sum_.y), hn::MulAdd(factor, x.z, sum_.z)};
    }
    HWY_INLINE void store(Vec4* out) const
    {
        *out = Vec4(hn::GetLane(sum_.x), hn::GetLane(sum_.y), hn::GetLane(sum_.z), 0);
    }

  private:
    V4 own_;
    V3 sum_;
#else
    HWY_INLINE explicit GradientSum(const Vec4& point)
        : own_(hn::LoadDup128(Floats(), reinterpret_cast<const float*>(&point))), even_(hn::Zero(Floats())), odd_(even_)
    {
    }
    template <class Neighbours>
    HWY_INLINE void add(const Vec4* points, const Neighbours& neighbours, V slope)
    {
        const auto added = [&](V other, V of_pair, V sum) FLOTSAM_INLINE {
            return hn::MulAdd(hn::Mul(of_pair, hn::Broadcast<3>(other)), hn::Sub(own_, other), sum);
        };
        even_ = added(load_points(points, neighbours, 0), hn::Broadcast<0>(slope), even_);
        odd_ = added(load_points(points, neighbours, 1), hn::Broadcast<1>(slope), odd_);
        even_ = added(load_points(points, neighbours, 2), hn::Broadcast<2>(slope), even_);
        odd_ = added(load_points(points, neighbours, 3), hn::Broadcast<3>(slope), odd_);
    }
    HWY_INLINE void store(Vec4* out) const
    {
        const hn::FixedTag<float, 4> four;
        const V sum = hn::Add(even_, odd_);
        float* c = reinterpret_cast<float*>(out);
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON || HWY_TARGET == HWY_EMU128
        hn::Store(sum, four, c);
#else
        hn::Store(hn::Add(hn::LowerHalf(four, sum), hn::UpperHalf(four, sum)), four, c);
#endif
        c[3] = 0;
    }

  private:
    V own_, even_, odd_;
#endif
};

/// sum_j slope_j (x_i - x_j) . v_j, without transposing; the velocities' fourth components are 0.
class DivergenceSum {
  public:
#if HWY_TARGET == HWY_SCALAR
    HWY_INLINE explicit DivergenceSum(const Vec4& point) : own_(broadcast(point)), even_(hn::Zero(Floats())) {}
    template <class Neighbours>
    HWY_INLINE void add(const Vec4* position, const Vec4* velocity, const Neighbours& neighbours, V slope)
    {
        const V3 x = difference(own_, load_transposed(position, neighbours));
        even_ = hn::MulAdd(slope, dot(x, load_transposed(velocity, neighbours)), even_);
    }
    [[nodiscard]] HWY_INLINE float total() const
    {
        return hn::GetLane(even_);
    }

  private:
    V4 own_;
    V even_;
#else
    HWY_INLINE explicit DivergenceSum(const Vec4& point)
        : own_(hn::LoadDup128(Floats(), reinterpret_cast<const float*>(&point))), even_(hn::Zero(Floats())), odd_(even_)
    {
    }
    template <class Neighbours>
    HWY_INLINE void add(const Vec4* position, const Vec4* velocity, const Neighbours& neighbours, V slope)
    {
        const auto added = [&](int lane, V of_pair, V sum) FLOTSAM_INLINE {
            const V arm = hn::Sub(own_, load_points(position, neighbours, lane));
            return hn::MulAdd(of_pair, hn::Mul(arm, load_points(velocity, neighbours, lane)), sum);
        };
        even_ = added(0, hn::Broadcast<0>(slope), even_);
        odd_ = added(1, hn::Broadcast<1>(slope), odd_);
        even_ = added(2, hn::Broadcast<2>(slope), even_);
        odd_ = added(3, hn::Broadcast<3>(slope), odd_);
    }
    [[nodiscard]] HWY_INLINE float total() const
    {
        return sum_lanes(hn::Add(even_, odd_));
    }

  private:
    V own_, even_, odd_;
#endif
};

HWY_INLINE void store_vec3(const V3& v, Vec4* out)
{
    float* c = reinterpret_cast<float*>(out);
    c[0] = sum_lanes(v.x);
    c[1] = sum_lanes(v.y);
    c[2] = sum_lanes(v.z);
    c[3] = 0;
}

} // namespace flotsam::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
