// Lists the centres that reach each block of a pass, a vector of centres at a time. Included once
// for each instruction set (Highway's foreach_target).

#if defined(NENDO_SIMD_LISTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_LISTS_INL
#undef NENDO_SIMD_LISTS_INL
#else
#define NENDO_SIMD_LISTS_INL
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

/// Writes, for each box, the centres that reach it, to lists that are `stride` apart.
HWY_INLINE void list_reaching(const CentreArrays& centres, const BlockBounds* boxes,
                              std::size_t count, std::uint32_t* list, std::size_t stride,
                              std::size_t* sizes) {
  for (std::size_t box = 0; box < count; ++box, list += stride) {
    std::size_t size = 0;
    for (std::size_t at = 0; at < centres.count; at += hn::Lanes(ListVectors()))
      size += store_reaching(load_centres(centres, at), boxes[box], list + size);
    sizes[box] = size;
  }
}

/// Does the same if all centres fit into so many vectors, which then stay in registers.
template <std::size_t vectors>
HWY_INLINE void list_reaching_few(const CentreArrays& centres, const BlockBounds* boxes,
                                  std::size_t count, std::uint32_t* list, std::size_t stride,
                                  std::size_t* sizes) {
  CentreVector held[vectors];
  for (std::size_t n = 0; n < vectors; ++n)
    held[n] = load_centres(centres, n * hn::Lanes(ListVectors()));
  for (std::size_t box = 0; box < count; ++box, list += stride) {
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

/// Copies the centres that reach a box to `to`.
static HWY_NOINLINE CentreArrays gather_reaching(const CentreArrays& centres,
                                                 const BlockBounds& box,
                                                 const CandidateArrays& to) {
  const ListVectors d;
  std::size_t count = 0;
  for (std::size_t at = 0; at < centres.count; at += hn::Lanes(d)) {
    const auto reached = reaching(load_centres(centres, at), box);
    if constexpr (hn::MaxLanes(ListVectors()) >= 16) {
      const hn::RebindToUnsigned<ListVectors> du;
      const auto take = [&](const float* from, float* place) HWY_ATTR {
        hn::StoreU(hn::Compress(hn::Load(d, from + at), reached), d, place + count);
      };
      const auto names = hn::Load(du, centres.names + at);
      hn::StoreU(hn::Compress(names, hn::RebindMask(du, reached)), du, to.names + count);
      take(centres.x, to.x);
      take(centres.y, to.y);
      take(centres.z, to.z);
      take(centres.squared_radius, to.squared_radius);
      count += hn::CountTrue(d, reached);
      continue;
    }
    auto bits = static_cast<std::uint32_t>(bits_of(ListVectors(), reached));
    for (; bits != 0; bits &= bits - 1, ++count) {
      const std::size_t from = at + static_cast<std::size_t>(std::countr_zero(bits));
      to.names[count] = centres.names[from];
      to.x[count] = centres.x[from];
      to.y[count] = centres.y[from];
      to.z[count] = centres.z[from];
      to.squared_radius[count] = centres.squared_radius[from];
    }
  }
  hn::StoreU(hn::Set(d, -1.0F), d, to.squared_radius + count); // of no centre: reaches nothing
  return {to.x, to.y, to.z, to.squared_radius, to.names, count};
}

/// With more centres than this, groups of neighbouring blocks are tested first: 256 blocks against
/// all centres, then 16 blocks against those that reach the 256.
constexpr std::size_t max_ungrouped = 32;
constexpr std::size_t groups_together = 16;

/// Up to 16 blocks of a pass, with the centres that reach each. Their lists are made together, so
/// that the sizes on which a block's work branches are known well before.
struct ListedBlocks {
  const CentreArrays& all;
  const BlockPass& pass;
  CentreArrays near{}, nearest{};
  std::size_t near_end = 0;
  std::size_t begin = 0, end = 0;
  std::size_t fetched = 0;
  std::size_t sizes[group_size]{};

  HWY_INLINE const std::uint32_t* list(std::size_t block) const {
    return pass.scratch.lists + (block - begin) * padded_list_size(nearest.count);
  }
};

/// Lists the next blocks. It is compiled once for all kinds of work.
static HWY_NOINLINE void list_next(ListedBlocks& blocks) {
  const auto least = [](std::size_t a, std::size_t b) { return a < b ? a : b; };
  const BlockPass& pass = blocks.pass;
  blocks.begin = blocks.end;
  blocks.end = least(blocks.begin + group_size, pass.end);
  if (blocks.all.count <= max_ungrouped) {
    blocks.nearest = blocks.all;
  } else {
    if (blocks.near_end <= blocks.begin) {
      blocks.near_end = least(blocks.begin + group_size * groups_together, pass.end);
      blocks.near =
          gather_reaching(blocks.all, common_bounds(pass.bounds, blocks.begin, blocks.near_end),
                          pass.scratch.candidates[0]);
    }
    blocks.nearest =
        gather_reaching(blocks.near, common_bounds(pass.bounds, blocks.begin, blocks.end),
                        pass.scratch.candidates[1]);
  }
  const auto list = [&](const auto& by) HWY_ATTR {
    by(blocks.nearest, pass.bounds + blocks.begin, blocks.end - blocks.begin, pass.scratch.lists,
       padded_list_size(blocks.nearest.count), blocks.sizes);
  };
  const std::size_t lanes = hn::Lanes(ListVectors());
  if (blocks.nearest.count <= lanes) return list(list_reaching_few<1>);
  if (blocks.nearest.count <= 2 * lanes) return list(list_reaching_few<2>);
  list(list_reaching);
}

/// Computes the bounds of written blocks together, because each block alone would have to wait for
/// its vertices.
static HWY_NOINLINE void measure_bounds(const BlockPass& pass, std::size_t begin, std::size_t end) {
  for (std::size_t block = begin; block < end; ++block)
    if (pass.reached[block] > 0)
      pass.new_bounds[block] = vector_bounds(ListVectors(), pass.to[block]);
}

/// Prefetches the vertices of listed blocks that something reaches, up to and including `last`.
/// Processors do not get so far ahead by themselves, because they cannot predict the lengths of the
/// lists.
static HWY_NOINLINE void fetch_until(ListedBlocks& blocks, std::size_t last) {
  if (blocks.fetched < blocks.begin) blocks.fetched = blocks.begin;
  for (; blocks.fetched < blocks.end && blocks.fetched <= last; ++blocks.fetched) {
    if (blocks.sizes[blocks.fetched - blocks.begin] > 0) fetch(blocks.pass.from[blocks.fetched]);
  }
}

/// Calls work.on_block(block, list, size) for the blocks of a pass, with the centres that reach
/// each.
template <class Work>
HWY_INLINE void for_each_block(const CentreArrays& centres, const BlockPass& pass, Work& work) {
  ListedBlocks blocks{centres, pass};
  for (blocks.end = pass.begin; blocks.end < pass.end;) {
    list_next(blocks);
    for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
      if (pass.large) fetch_until(blocks, block + fetched_ahead);
      work.on_block(block, blocks.list(block), blocks.sizes[block - blocks.begin]);
    }
    if (pass.new_bounds != nullptr) measure_bounds(pass, blocks.begin, blocks.end);
  }
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
