// Finds the centres that reach a box, or several boxes, a vector of centres at a time. Included
// once for each instruction set (Highway's foreach_target).

#if defined(NENDO_SIMD_REACHING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_REACHING_INL
#undef NENDO_SIMD_REACHING_INL
#else
#define NENDO_SIMD_REACHING_INL
#endif

#include <array>
#include <bit>
#include <cstdint>

#include <hwy/highway.h>

#include "simd/field_kernels.hpp"
#include "simd/kernels-inl.hpp"

#ifndef NENDO_SIMD_SET_LANES
#define NENDO_SIMD_SET_LANES
namespace nendo::deform {

/// For each byte, the numbers of the bits that are set, and then zeros.
inline constexpr std::array<std::array<std::uint8_t, 8>, 256> set_lanes = [] {
  std::array<std::array<std::uint8_t, 8>, 256> all{};
  for (std::size_t byte = 0; byte < 256; ++byte) {
    std::size_t size = 0;
    for (std::uint8_t bit = 0; bit < 8; ++bit)
      if ((byte >> bit & 1U) != 0) all[byte][size++] = bit;
  }
  return all;
}();

} // namespace nendo::deform
#endif

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using ListVectors = hn::ScalableTag<float>;

/// As many centres as a vector has lanes.
struct CentreVector {
  hn::Vec<ListVectors> x, y, z, squared_radius;
  const std::uint32_t* names;
};

HWY_INLINE CentreVector load_centres(const CentreArrays& centres, std::size_t at) {
  const ListVectors d;
  return {hn::Load(d, centres.x + at), hn::Load(d, centres.y + at), hn::Load(d, centres.z + at),
          hn::Load(d, centres.squared_radius + at), centres.names + at};
}

/// Returns those that reach a box: their squared distance to it is at most the squared radius.
HWY_INLINE hn::Mask<ListVectors> reaching(const CentreVector& centres, const BlockBounds& box) {
  const ListVectors d;
  const auto outside = [&](hn::Vec<ListVectors> centre, std::size_t axis) HWY_ATTR {
    const auto below = hn::Sub(hn::Set(d, box.sides[axis]), centre);
    const auto above = hn::Add(hn::Set(d, box.sides[axis + 4]), centre);
    return hn::Max(hn::Max(below, above), hn::Zero(d));
  };
  const auto x = outside(centres.x, 0);
  const auto y = outside(centres.y, 1);
  const auto z = outside(centres.z, 2);
  const auto squared = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
  return hn::Le(squared, centres.squared_radius);
}

/// Stores the lanes whose bits are set and overwrites what is beyond them. It does not branch on
/// the bits, which a processor could not predict.
HWY_INLINE void store_set_lanes(const std::uint32_t* from, std::uint32_t bits, std::uint32_t* to) {
  const hn::ScalableTag<std::uint32_t> d;
  if constexpr (hn::MaxLanes(d) == 8) { // AVX2: Highway's Compress copies its table each time
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto lanes = hn::PromoteTo(d, hn::Load(bytes, set_lanes[bits].data()));
    hn::StoreU(hn::TableLookupLanes(hn::Load(d, from), hn::IndicesFromVec(d, lanes)), d, to);
  } else {
    std::size_t size = 0;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      to[size] = from[lane];
      size += bits >> lane & 1U;
    }
  }
}

/// Stores the names of those centres that reach a box, and returns how many they are.
HWY_INLINE std::size_t store_reaching(const CentreVector& centres, const BlockBounds& box,
                                      std::uint32_t* to) {
  const ListVectors d;
  const auto reached = reaching(centres, box);
  if constexpr (hn::MaxLanes(ListVectors()) >= 16) { // an instruction
    const hn::RebindToUnsigned<ListVectors> du;
    hn::StoreU(hn::Compress(hn::Load(du, centres.names), hn::RebindMask(du, reached)), du, to);
    return hn::CountTrue(d, reached);
  } else {
    const auto bits = static_cast<std::uint32_t>(bits_of(ListVectors(), reached));
    store_set_lanes(centres.names, bits, to);
    return static_cast<std::size_t>(std::popcount(bits));
  }
}

/// Writes, for each box, the centres that reach it, to lists that are `room` apart.
HWY_INLINE void list_reaching(const CentreArrays& centres, const BlockBounds* boxes,
                              std::size_t count, std::uint32_t* list, std::size_t room,
                              std::size_t* sizes) {
  for (std::size_t box = 0; box < count; ++box, list += room) {
    std::size_t size = 0;
    for (std::size_t at = 0; at < centres.count; at += hn::Lanes(ListVectors()))
      size += store_reaching(load_centres(centres, at), boxes[box], list + size);
    sizes[box] = size;
  }
}

/// Does the same if all centres fit into so many vectors, which then stay in registers.
template <std::size_t vectors>
HWY_INLINE void list_reaching_few(const CentreArrays& centres, const BlockBounds* boxes,
                                  std::size_t count, std::uint32_t* list, std::size_t room,
                                  std::size_t* sizes) {
  CentreVector held[vectors];
  for (std::size_t n = 0; n < vectors; ++n)
    held[n] = load_centres(centres, n * hn::Lanes(ListVectors()));
  for (std::size_t box = 0; box < count; ++box, list += room) {
    std::size_t size = 0;
    for (const CentreVector& few : held)
      size += store_reaching(few, boxes[box], list + size);
    sizes[box] = size;
  }
}

HWY_INLINE BlockBounds common_bounds(const BlockBounds* bounds, std::size_t begin,
                                     std::size_t end) {
  BlockBounds box = bounds[begin];
  for (std::size_t block = begin + 1; block < end; ++block)
    for (std::size_t side = 0; side < box.sides.size(); ++side)
      box.sides[side] =
          bounds[block].sides[side] < box.sides[side] ? bounds[block].sides[side] : box.sides[side];
  return box;
}

/// Copies the centres that reach a box to `room`.
static HWY_NOINLINE CentreArrays gather_reaching(const CentreArrays& centres,
                                                 const BlockBounds& box,
                                                 const CandidateRoom& room) {
  const ListVectors d;
  std::size_t count = 0;
  for (std::size_t at = 0; at < centres.count; at += hn::Lanes(d)) {
    const auto reached = reaching(load_centres(centres, at), box);
    if constexpr (hn::MaxLanes(ListVectors()) >= 16) {
      const hn::RebindToUnsigned<ListVectors> du;
      const auto take = [&](const float* from, float* to) HWY_ATTR {
        hn::StoreU(hn::Compress(hn::Load(d, from + at), reached), d, to + count);
      };
      const auto names = hn::Load(du, centres.names + at);
      hn::StoreU(hn::Compress(names, hn::RebindMask(du, reached)), du, room.names + count);
      take(centres.x, room.x);
      take(centres.y, room.y);
      take(centres.z, room.z);
      take(centres.squared_radius, room.squared_radius);
      count += hn::CountTrue(d, reached);
      continue;
    }
    auto bits = static_cast<std::uint32_t>(bits_of(ListVectors(), reached));
    for (; bits != 0; bits &= bits - 1, ++count) {
      const std::size_t from = at + static_cast<std::size_t>(std::countr_zero(bits));
      room.names[count] = centres.names[from];
      room.x[count] = centres.x[from];
      room.y[count] = centres.y[from];
      room.z[count] = centres.z[from];
      room.squared_radius[count] = centres.squared_radius[from];
    }
  }
  hn::StoreU(hn::Set(d, -1.0F), d, room.squared_radius + count); // of nobody: reaches nothing
  return {room.x, room.y, room.z, room.squared_radius, room.names, count};
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
