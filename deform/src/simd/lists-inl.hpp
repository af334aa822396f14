// Which centres reach a block. Included once for each instruction set (Highway's foreach_target).

#if defined(NENDO_SIMD_LISTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_LISTS_INL
#undef NENDO_SIMD_LISTS_INL
#else
#define NENDO_SIMD_LISTS_INL
#endif

#include <bit>

#include <hwy/highway.h>

#include "simd/field_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Blocks whose lists are made together, each in a lane of its own.
constexpr std::size_t group_size = 16;
/// With more centres than this, a group asks first which of them reach its common box.
constexpr std::size_t most_ungrouped = 32;
constexpr std::size_t bits_a_word = 32;

/// Squared distance to a box, of which low and negated high sides are given.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V box_distance(D d, const V (&centre)[3], const V (&low)[3],
                          const V (&negated_high)[3]) {
  const V zero = hn::Zero(d);
  V squared = zero;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const V below = hn::Sub(low[axis], centre[axis]);
    const V above = hn::Add(negated_high[axis], centre[axis]);
    const V outside = hn::Max(hn::Max(below, above), zero);
    squared = hn::MulAdd(outside, outside, squared);
  }
  return squared;
}

/// Marks which centres reach which of up to 16 blocks: bit c % 32 of words[c / 32 * 16 + block].
HWY_INLINE void mark_group(const CentreArrays& centres, const BlockBounds* bounds,
                           std::size_t count, std::uint32_t* words) {
  const hn::CappedTag<float, group_size> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  using V = hn::Vec<decltype(d)>;
  alignas(64) float sides[6][group_size];
  for (std::size_t block = 0; block < group_size; ++block) {
    const auto& box = bounds[block < count ? block : count - 1].sides;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sides[axis][block] = box[axis];
      sides[axis + 3][block] = box[axis + 4];
    }
  }
  for (std::size_t lane = 0; lane < group_size; lane += hn::Lanes(d)) {
    const V low[3] = {hn::Load(d, sides[0] + lane), hn::Load(d, sides[1] + lane),
                      hn::Load(d, sides[2] + lane)};
    const V negated_high[3] = {hn::Load(d, sides[3] + lane), hn::Load(d, sides[4] + lane),
                               hn::Load(d, sides[5] + lane)};
    for (std::size_t begin = 0; begin < centres.count; begin += bits_a_word) {
      auto bits = hn::Zero(du);
      for (std::size_t c = begin; c < begin + bits_a_word && c < centres.count; ++c) {
        const V centre[3] = {hn::Set(d, centres.x[c]), hn::Set(d, centres.y[c]),
                             hn::Set(d, centres.z[c])};
        const auto reached = hn::Le(box_distance(d, centre, low, negated_high),
                                    hn::Set(d, centres.squared_radius[c]));
        const auto bit = hn::Set(du, std::uint32_t{1} << (c - begin));
        bits = hn::Or(bits, hn::IfThenElseZero(hn::RebindMask(du, reached), bit));
      }
      hn::Store(bits, du, words + begin / bits_a_word * group_size + lane);
    }
  }
}

/// The centres marked for a block, by their places or, if that is not null, by `names`.
HWY_INLINE std::size_t list_marked(const std::uint32_t* words, std::size_t block,
                                   std::size_t centres, const std::uint32_t* names,
                                   std::uint32_t* list) {
  std::size_t size = 0;
  for (std::size_t begin = 0; begin < centres; begin += bits_a_word) {
    std::uint32_t bits = words[begin / bits_a_word * group_size + block];
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t at = begin + static_cast<std::size_t>(std::countr_zero(bits));
      list[size++] = names != nullptr ? names[at] : static_cast<std::uint32_t>(at);
    }
  }
  return size;
}

/// The centres that reach the box of several blocks, gathered in the scratch; their names in
/// scratch.candidate.
HWY_INLINE CentreArrays gather_candidates(const CentreArrays& centres, const BlockBounds& box,
                                          const ListScratch& scratch) {
  const hn::ScalableTag<float> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  std::size_t count = 0;
  using V = hn::Vec<decltype(d)>;
  const auto& sides = box.sides;
  const V low[3] = {hn::Set(d, sides[0]), hn::Set(d, sides[1]), hn::Set(d, sides[2])};
  const V negated_high[3] = {hn::Set(d, sides[4]), hn::Set(d, sides[5]), hn::Set(d, sides[6])};
  for (std::size_t at = 0; at < centres.count; at += hn::Lanes(d)) {
    const V centre[3] = {hn::Load(d, centres.x + at), hn::Load(d, centres.y + at),
                         hn::Load(d, centres.z + at)};
    const auto reach = hn::Load(d, centres.squared_radius + at);
    const auto reached = hn::Le(box_distance(d, centre, low, negated_high), reach);
    if (hn::AllFalse(d, reached)) continue;
    const auto name = hn::Iota(du, static_cast<std::uint32_t>(at));
    hn::StoreU(hn::Compress(name, hn::RebindMask(du, reached)), du, scratch.candidate + count);
    hn::StoreU(hn::Compress(hn::Load(d, centres.x + at), reached), d, scratch.x + count);
    hn::StoreU(hn::Compress(hn::Load(d, centres.y + at), reached), d, scratch.y + count);
    hn::StoreU(hn::Compress(hn::Load(d, centres.z + at), reached), d, scratch.z + count);
    hn::StoreU(hn::Compress(reach, reached), d, scratch.squared_radius + count);
    count += hn::CountTrue(d, reached);
  }
  return {scratch.x, scratch.y, scratch.z, scratch.squared_radius, count};
}

HWY_INLINE BlockBounds group_bounds(const BlockBounds* bounds, std::size_t begin, std::size_t end) {
  BlockBounds box = bounds[begin];
  for (std::size_t block = begin + 1; block < end; ++block)
    for (std::size_t side = 0; side < box.sides.size(); ++side)
      box.sides[side] =
          bounds[block].sides[side] < box.sides[side] ? bounds[block].sides[side] : box.sides[side];
  return box;
}

/// Calls work(block, list, size) for the blocks of a pass, with the centres that reach each.
template <class Work>
HWY_INLINE void for_each_block(const CentreArrays& all, const BlockPass& pass, Work& work) {
  const bool grouped = all.count > most_ungrouped;
  const ListScratch& scratch = pass.scratch;
  for (std::size_t begin = pass.begin; begin < pass.end; begin += group_size) {
    const std::size_t end = begin + group_size < pass.end ? begin + group_size : pass.end;
    const CentreArrays centres =
        grouped ? gather_candidates(all, group_bounds(pass.bounds, begin, end), scratch) : all;
    mark_group(centres, pass.bounds + begin, end - begin, scratch.words);
    for (std::size_t block = begin; block < end; ++block) {
      const std::size_t size = list_marked(scratch.words, block - begin, centres.count,
                                           grouped ? scratch.candidate : nullptr, scratch.list);
      work.on_block(block, scratch.list, size);
    }
  }
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
