// Compiled once for each instruction set: foreach_target.h includes this file again and again.
#include "sph/simd/targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sph/simd/search_passes.cpp" // NOLINT
#include <hwy/foreach_target.h>

#include "sph/simd/lanes.hpp"
#include "sph/simd/search_passes.hpp"

#include <algorithm>
#include <array>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace flotsam::simd::HWY_NAMESPACE {

/// For each mask, the lanes that it has, rising, and then any.
[[maybe_unused]] constexpr auto kCompressed = [] {
    std::array<std::array<std::int32_t, kLanes>, std::size_t{1} << kLanes> table{};
    for (std::size_t mask = 0; mask < table.size(); ++mask) {
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < kLanes; ++lane)
            if ((mask >> lane & 1) != 0) table[mask][count++] = static_cast<std::int32_t>(lane);
    }
    return table;
}();

/// Ranges of the lists that hold the points of the 3 x 3 x 3 cells around a cell; the cells of a row are one.
struct Ranges {
    std::uint32_t first[9], last[9];
    int count = 0;
    std::size_t points = 0; ///< in all of them
    std::uint32_t cell = ~std::uint32_t(0);
};

inline void find_ranges(const CellGrid& grid, const CellLists& lists, const Eigen::Vector3i& home, Ranges& ranges)
{
    ranges.count = 0;
    ranges.points = 0;
    grid.visit_rows(home, 1, [&](std::uint32_t first_cell, std::uint32_t last_cell) {
        const std::uint32_t first = lists.start[first_cell], last = lists.start[last_cell + 1];
        if (first == last) return;
        ranges.first[ranges.count] = first;
        ranges.last[ranges.count++] = last;
        ranges.points += last - first;
    });
}

/// Ranges of the candidates of point i.
HWY_INLINE void enter_cell_of(const Search& search, std::size_t i, Ranges& ranges)
{
    const Eigen::Vector3i home = search.grid->cell_of(search.points[i]);
    const std::uint32_t cell = search.grid->index_of(home);
    if (cell == ranges.cell) return;
    find_ranges(*search.grid, *search.lists, home, ranges);
    ranges.cell = cell;
}

/// Calls visit(indices, which are near, r^2) for each group of candidates of point i, whose ranges are given.
template <class Visit>
HWY_INLINE void for_candidates(const Search& search, std::size_t i, const Ranges& ranges, Visit&& visit)
{
    const Floats d;
    const Ints du;
    const CellLists& lists = *search.lists;
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

/// Stores the first `count` lanes; up to all of them where that does not go beyond `room` entries.
template <class D, class Lanes, class T>
HWY_INLINE void store_first(D d, Lanes v, std::size_t count, std::size_t room, T* out)
{
    if (kLanes <= room) {
        hn::StoreU(v, d, out);
        return;
    }
    HWY_ALIGN T values[kLanes];
    hn::Store(v, d, values);
    std::copy_n(values, count, out);
}

void count_neighbours(const Search& search, std::size_t begin, std::size_t end, std::uint32_t* counts)
{
    Ranges ranges;
    for (std::size_t i = begin; i < end; ++i) {
        std::size_t count = 0;
        enter_cell_of(search, i, ranges);
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
        enter_cell_of(search, i, ranges);
        for_candidates(search, i, ranges, [&](U index, auto near, V distance_sq) FLOTSAM_INLINE {
            const std::size_t count = hn::CountTrue(d, near);
            const U kept = compress(du, index, hn::RebindMask(du, near));
            const V kept_sq = compress(d, distance_sq, near);
            // What is too much falls into this chunk's rows, which are written later.
            store_first(du, kept, count, chunk_end - k, pairs.index.data() + k);
            store_first(d, kept_sq, count, chunk_end - k, pairs.slope.data() + k);
            k += count;
        });
    }
}

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
            // What follows are squared distances still, or another thread's.
            store_first(d, slope, last - k, last - k, pairs.slope.data() + k);
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

/// For `size` values at least, and as many again when there are more than ever before.
template <class T>
HWY_INLINE void make_room(std::size_t size, std::vector<T>& values)
{
    if (values.size() < size) values.resize(2 * size);
}

/// Neighbours of point i and their squared distances, in rows.found and rows.distance_sq; how many there are.
HWY_INLINE std::size_t gather(const Search& search, std::size_t i, Ranges& ranges, SelfRows& rows)
{
    const Floats d;
    const Ints du;
    enter_cell_of(search, i, ranges);
    make_room(ranges.points + kLanes, rows.found);
    make_room(ranges.points + kLanes, rows.distance_sq);
    std::uint32_t* found = rows.found.data();
    float* distance_sq = rows.distance_sq.data();
    std::size_t count = 0;
    for_candidates(search, i, ranges, [&](U other, auto near, V sq) FLOTSAM_INLINE {
        hn::StoreU(compress(du, other, hn::RebindMask(du, near)), du, found + count);
        hn::StoreU(compress(d, sq, near), d, distance_sq + count);
        count += hn::CountTrue(d, near);
    });
    return count;
}

template <class Kernel>
HWY_INLINE std::uint32_t find_rows(const Search& search, const Kernel& kernel, std::size_t begin, std::size_t end,
                                   SelfRows& rows, SelfPairs& pairs)
{
    const Floats d;
    const Ints du;
    const SignedInts di;
    const V parts_per_slope = set(1 / pairs.unit);
    const bool far = pairs.is_far();
    Ranges ranges;
    auto reach = hn::Zero(di);
    rows.length.resize(end - begin);
    std::size_t first = 0; // of the row in the rows
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t count = gather(search, i, ranges, rows);
        make_room(first + count + kLanes, rows.parts);
        far ? make_room(first + count + kLanes, rows.index) : make_room(first + count + kLanes, rows.offset);
        const auto own = hn::Set(di, static_cast<std::int32_t>(i));
        V sum = hn::Zero(d);
        for (std::size_t k = 0; k < count; k += kLanes) { // what is too much falls into the next row's place
            const auto in_row = hn::FirstN(d, std::min(kLanes, count - k));
            V slope, value;
            kernel(hn::Sqrt(hn::IfThenElseZero(in_row, hn::LoadU(d, rows.distance_sq.data() + k))), slope, value);
            sum = hn::Add(sum, hn::IfThenElseZero(in_row, value));
            const auto parts = hn::NearestInt(hn::Mul(slope, parts_per_slope));
            hn::StoreU(hn::DemoteTo(UnsignedShorts(), parts), UnsignedShorts(), rows.parts.data() + first + k);
            const U index = hn::LoadU(du, rows.found.data() + k);
            const auto offset = hn::Sub(hn::BitCast(di, index), own);
            reach = hn::Max(reach, hn::IfThenElseZero(hn::RebindMask(di, in_row), hn::Abs(offset)));
            if (far)
                hn::StoreU(index, du, rows.index.data() + first + k);
            else
                hn::StoreU(hn::DemoteTo(Shorts(), offset), Shorts(), rows.offset.data() + first + k);
        }
        pairs.kernel_sum[i] = sum_lanes(sum);
        rows.length[i - begin] = static_cast<std::uint32_t>(count);
        first += count;
    }
    return static_cast<std::uint32_t>(hn::GetLane(hn::MaxOfLanes(di, reach)));
}

std::uint32_t find_quintic_rows(const Search& search, const QuinticSpline& kernel, std::size_t begin, std::size_t end,
                                SelfRows& rows, SelfPairs& pairs)
{
    return find_rows(search, Quintic(kernel), begin, end, rows, pairs);
}

std::uint32_t find_cubic_rows(const Search& search, const CubicSpline& kernel, std::size_t begin, std::size_t end,
                              SelfRows& rows, SelfPairs& pairs)
{
    return find_rows(search, Cubic(kernel), begin, end, rows, pairs);
}

} // namespace flotsam::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flotsam::simd {

HWY_EXPORT(count_neighbours);
HWY_EXPORT(write_neighbours);
HWY_EXPORT(evaluate_quintic);
HWY_EXPORT(evaluate_cubic);
HWY_EXPORT(find_quintic_rows);
HWY_EXPORT(find_cubic_rows);

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

std::uint32_t find_self_rows(const Search& search, const QuinticSpline& kernel, std::size_t begin, std::size_t end,
                             SelfRows& rows, SelfPairs& pairs)
{
    return HWY_DYNAMIC_DISPATCH(find_quintic_rows)(search, kernel, begin, end, rows, pairs);
}

std::uint32_t find_self_rows(const Search& search, const CubicSpline& kernel, std::size_t begin, std::size_t end,
                             SelfRows& rows, SelfPairs& pairs)
{
    return HWY_DYNAMIC_DISPATCH(find_cubic_rows)(search, kernel, begin, end, rows, pairs);
}

} // namespace flotsam::simd
#endif
