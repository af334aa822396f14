// Lists the centres that reach each block of a pass. Included once for each instruction set
// (Highway's foreach_target).

#if defined(NENDO_SIMD_LISTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_LISTS_INL
#undef NENDO_SIMD_LISTS_INL
#else
#define NENDO_SIMD_LISTS_INL
#endif

#include <cstdint>

#include <hwy/highway.h>

#include "simd/field_kernels.hpp"
#include "simd/kernels-inl.hpp"
#include "simd/reaching-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
    return pass.scratch.lists + (block - begin) * list_room(nearest.count);
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
       list_room(blocks.nearest.count), blocks.sizes);
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
