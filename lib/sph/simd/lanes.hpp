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
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_NEON || HWY_TARGET == HWY_EMU128
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

} // namespace flotsam::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
