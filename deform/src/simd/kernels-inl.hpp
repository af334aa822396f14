// Vector code for the Wendland functions and for vertices. It is included once for each instruction
// set (Highway's foreach_target).

#if defined(NENDO_SIMD_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_KERNELS_INL
#undef NENDO_SIMD_KERNELS_INL
#else
#define NENDO_SIMD_KERNELS_INL
#endif

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "simd/field_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Vectors3 {
  V x, y, z;
};

// Coordinates are stored in float, also where sums are in double.
template <class D>
HWY_INLINE hn::Vec<D> load_as(D d, const float* from) {
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
    return hn::Load(d, from);
  } else {
    return hn::PromoteTo(d, hn::Load(hn::Rebind<float, D>(), from));
  }
}
template <class D>
HWY_INLINE void store_from(D d, hn::Vec<D> values, float* to) {
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
    hn::Store(values, d, to);
  } else {
    const hn::Rebind<float, D> df;
    hn::Store(hn::DemoteTo(df, values), df, to);
  }
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> load_vectors(D d, const VertexBlock& block, std::size_t lane) {
  return {load_as(d, block.x.data() + lane), load_as(d, block.y.data() + lane),
          load_as(d, block.z.data() + lane)};
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void store_vectors(D d, const Vectors3<V>& values, VertexBlock& to, std::size_t lane) {
  store_from(d, values.x, to.x.data() + lane);
  store_from(d, values.y, to.y.data() + lane);
  store_from(d, values.z, to.z.data() + lane);
}

/// Stores past the caches. Other threads may read the block after hwy::FlushStream().
template <class D, class V = hn::Vec<D>>
HWY_INLINE void stream_vectors(D, const Vectors3<V>& values, VertexBlock& to, std::size_t lane) {
  const hn::Rebind<float, D> df;
  const auto stream = [df, lane](V coordinates, std::array<float, block_size>& all) HWY_ATTR {
    if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
      hn::Stream(coordinates, df, all.data() + lane);
    } else {
      hn::Stream(hn::DemoteTo(df, coordinates), df, all.data() + lane);
    }
  };
  stream(values.x, to.x);
  stream(values.y, to.y);
  stream(values.z, to.z);
}

/// Returns a mask as bits; bit n is lane n.
template <class D>
HWY_INLINE std::uint64_t bits_of(D d, hn::Mask<D> mask) {
  alignas(8) std::array<std::uint8_t, 8> bytes{}; // as many as Highway asks for
  hn::StoreMaskBits(d, mask, bytes.data());
  std::uint64_t bits = 0;
  std::memcpy(&bits, bytes.data(), sizeof(bits));
  return bits;
}

/// Shapes that do not stay in the caches are fetched this many blocks before their turn.
constexpr std::size_t fetched_ahead = 4;

HWY_INLINE void fetch(const VertexBlock& vertices) {
  for (const auto* coordinates : {&vertices.x, &vertices.y, &vertices.z})
    for (std::size_t at = 0; at < block_size; at += 64 / sizeof(float))
      hwy::Prefetch(coordinates->data() + at);
}

template <class V>
HWY_INLINE Vectors3<V> sum_of(const Vectors3<V>& a, const Vectors3<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Vectors3<V> difference_of(const Vectors3<V>& a, const Vectors3<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
/// Returns the way from an entry's x, y and z to the place.
template <class D, class Entry, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> relative_to(D d, const Entry& entry, const Vectors3<V>& place) {
  return {hn::Sub(place.x, hn::Set(d, entry.x)), hn::Sub(place.y, hn::Set(d, entry.y)),
          hn::Sub(place.z, hn::Set(d, entry.z))};
}
template <class V>
HWY_INLINE Vectors3<V> scaled(const Vectors3<V>& a, V by) {
  return {hn::Mul(a.x, by), hn::Mul(a.y, by), hn::Mul(a.z, by)};
}
template <class V>
HWY_INLINE V dot_product(const Vectors3<V>& a, const Vectors3<V>& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
/// The absolute values of a's coordinates by b's, added up: how much a product with a can change
/// within half the sides b.
template <class V>
HWY_INLINE V spread_of(const Vectors3<V>& a, const Vectors3<V>& b) {
  return hn::MulAdd(hn::Abs(a.x), b.x, hn::MulAdd(hn::Abs(a.y), b.y, hn::Mul(hn::Abs(a.z), b.z)));
}

/// Returns call(k) with k.value the kernel, as a constant.
template <class Call>
HWY_INLINE auto with_kernel(Wendland kernel, const Call& call) {
  switch (kernel) {
  case Wendland::c0:
    return call(std::integral_constant<Wendland, Wendland::c0>());
  case Wendland::c2:
    return call(std::integral_constant<Wendland, Wendland::c2>());
  case Wendland::c4:
    return call(std::integral_constant<Wendland, Wendland::c4>());
  case Wendland::c6:
    break;
  }
  return call(std::integral_constant<Wendland, Wendland::c6>());
}

/// Returns psi / kernel_factor for o = 1 - t, which is not negative.
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE V weight(D d, V o) {
  using Real = hn::TFromD<D>;
  const V o2 = hn::Mul(o, o);
  if constexpr (kernel == Wendland::c0) return o2;
  const V o4 = hn::Mul(o2, o2);
  if constexpr (kernel == Wendland::c2) return hn::Mul(o4, hn::Sub(hn::Set(d, Real(1.25)), o));
  if constexpr (kernel == Wendland::c4) {
    const V linear = hn::MulAdd(hn::Set(d, Real(35)), o, hn::Set(d, Real(-88)));
    return hn::Mul(hn::Mul(o4, o2), hn::MulAdd(linear, o, hn::Set(d, Real(56))));
  }
  const V linear = hn::MulAdd(hn::Set(d, Real(-32)), o, hn::Set(d, Real(121)));
  const V square = hn::MulAdd(linear, o, hn::Set(d, Real(-154)));
  return hn::Mul(hn::Mul(o4, o4), hn::MulAdd(square, o, hn::Set(d, Real(66))));
}

/// Returns o for an entry's centre, or r o (FieldEntry).
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE V depth(D d, const FieldEntry<hn::TFromD<D>>& entry, V distance) {
  if constexpr (weight_power(kernel) > 0) {
    return hn::Max(hn::Sub(hn::Set(d, entry.radius), distance), hn::Zero(d));
  } else {
    const V one = hn::Set(d, hn::TFromD<D>(1));
    return hn::Max(hn::NegMulAdd(distance, hn::Set(d, entry.inverse_radius), one), hn::Zero(d));
  }
}

/// Returns the factor of the entry's coefficients, from depth().
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE V weight_at(D d, const FieldEntry<hn::TFromD<D>>& entry, V depth) {
  if constexpr (kernel != Wendland::c2) return weight<kernel>(d, depth);
  const V squared = hn::Mul(depth, depth);
  return hn::Mul(hn::Mul(squared, squared), hn::Sub(hn::Set(d, entry.inner), depth));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V polynomial_row(D d, const std::array<double, 4>& row, const Vectors3<V>& place) {
  using Real = hn::TFromD<D>;
  V sum = hn::Set(d, static_cast<Real>(row[0]));
  sum = hn::MulAdd(place.x, hn::Set(d, static_cast<Real>(row[1])), sum);
  sum = hn::MulAdd(place.y, hn::Set(d, static_cast<Real>(row[2])), sum);
  return hn::MulAdd(place.z, hn::Set(d, static_cast<Real>(row[3])), sum);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> polynomial_at(D d, const std::array<std::array<double, 4>, 3>& rows,
                                     const Vectors3<V>& place) {
  return {polynomial_row(d, rows[0], place), polynomial_row(d, rows[1], place),
          polynomial_row(d, rows[2], place)};
}

/// Returns psi' / (t slope_factor) for t and o = max(1 - t, 0).
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE V slope(D d, V t, V o) {
  using Real = hn::TFromD<D>;
  // At its centre c0 has no derivative, so nothing is added there.
  if constexpr (kernel == Wendland::c0)
    return hn::IfThenElseZero(hn::Gt(t, hn::Zero(d)), hn::Div(o, t));
  const V o2 = hn::Mul(o, o);
  if constexpr (kernel == Wendland::c2) return hn::Mul(o2, o);
  const V o5 = hn::Mul(hn::Mul(o2, o2), o);
  if constexpr (kernel == Wendland::c4)
    return hn::Mul(o5, hn::NegMulAdd(hn::Set(d, Real(5)), o, hn::Set(d, Real(6))));
  const V linear = hn::MulAdd(hn::Set(d, Real(16)), o, hn::Set(d, Real(-39)));
  return hn::Mul(hn::Mul(o5, o2), hn::MulAdd(linear, o, hn::Set(d, Real(24))));
}

#if HWY_TARGET == HWY_SCALAR
template <class D, class V = hn::Vec<D>>
HWY_INLINE void store_min_lanes(D, const V (&low)[3], const V (&high)[3], float* to) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    to[axis] = hn::GetLane(low[axis]);
    to[axis + 4] = hn::GetLane(high[axis]);
  }
  to[3] = to[7] = 0.0F;
}
#else
/// Returns, in each four lanes, the least of those of three vectors, and a zero.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V min_in_fours(D d, const V (&three)[3]) {
  const hn::Repartition<double, D> pairs;
  const auto min_pairs = [d](V a, V b) { // a b a b in each four lanes
    return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  };
  const auto xy = hn::BitCast(pairs, min_pairs(three[0], three[1]));
  const auto z0 = hn::BitCast(pairs, min_pairs(three[2], hn::Zero(d)));
  return hn::Min(hn::BitCast(d, hn::InterleaveLower(pairs, xy, z0)),
                 hn::BitCast(d, hn::InterleaveUpper(pairs, xy, z0)));
}

/// Stores the least lanes of the vectors `low`, and a zero, to four aligned places; then of `high`.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void store_min_lanes(D d, const V (&low)[3], const V (&high)[3], float* to) {
  const V lows = min_in_fours(d, low);
  const V highs = min_in_fours(d, high);
  const hn::CappedTag<float, 4> four;
  if constexpr (hn::MaxLanes(D()) == 4) {
    hn::Store(lows, four, to);
    hn::Store(highs, four, to + 4);
  } else {
    const V both =
        hn::Min(hn::ConcatLowerLower(d, highs, lows), hn::ConcatUpperUpper(d, highs, lows));
    const hn::CappedTag<float, 8> eight;
    if constexpr (hn::MaxLanes(D()) == 8) {
      hn::Store(both, eight, to);
    } else { // lows, lows, highs, highs
      const V least = hn::Min(both, hn::SwapAdjacentBlocks(both));
      hn::Store(hn::LowerHalf(four, hn::LowerHalf(eight, least)), four, to);
      hn::Store(hn::LowerHalf(four, hn::UpperHalf(eight, least)), four, to + 4);
    }
  }
}
#endif

/// Returns the bounds of a block that has just been written.
template <class D, class V = hn::Vec<D>>
HWY_INLINE BlockBounds vector_bounds(D d, const VertexBlock& block) {
  const float* const coordinates[3] = {block.x.data(), block.y.data(), block.z.data()};
  V low[3];
  V high[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = hn::Load(d, coordinates[axis]);
    high[axis] = low[axis];
    for (std::size_t lane = hn::Lanes(d); lane < block_size; lane += hn::Lanes(d)) {
      const V more = hn::Load(d, coordinates[axis] + lane);
      low[axis] = hn::Min(low[axis], more);
      high[axis] = hn::Max(high[axis], more);
    }
  }
  for (V& highest : high)
    highest = hn::Neg(highest);
  BlockBounds bounds;
  store_min_lanes(d, low, high, bounds.sides.data());
  return bounds;
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
