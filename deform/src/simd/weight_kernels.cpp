// Type-1's weights, applied each frame.

#include "simd/weight_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/weight_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// So many vectors at a time: twelve sums fit the registers of every instruction set.
constexpr std::size_t abreast = 4;

/// weight(n): those of the n-th vector.
template <class D, class V, class Weight>
HWY_INLINE void add_weighted(D d, const std::array<float, 4>& by, const Weight& weight,
                             Vectors3<V> (&places)[abreast]) {
  const V by_x = hn::Set(d, by[0]);
  const V by_y = hn::Set(d, by[1]);
  const V by_z = hn::Set(d, by[2]);
  for (std::size_t n = 0; n < abreast; ++n) {
    const V w = weight(n);
    places[n].x = hn::MulAdd(w, by_x, places[n].x);
    places[n].y = hn::MulAdd(w, by_y, places[n].y);
    places[n].z = hn::MulAdd(w, by_z, places[n].z);
  }
}

/// What the middles of a block's weights in steps move all of its vertices by.
HWY_INLINE std::array<float, 4> moved_by_middles(const WeightEntry* entries, std::size_t count,
                                                 const std::array<float, 4>* displacements) {
  const hn::CappedTag<float, 4> d;
  HWY_ALIGN std::array<float, 4> moved{};
  for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (std::size_t k = 0; k < count; ++k)
      sum = hn::MulAdd(hn::Set(d, entries[k].middle),
                       hn::LoadU(d, displacements[entries[k].start].data() + lane), sum);
    hn::Store(sum, d, moved.data() + lane);
  }
  return moved;
}

HWY_INLINE void apply_block(const WeightCache& cache, const WeightedBlock& block,
                            const WeightPass& pass, bool streams) {
  const hn::ScalableTag<float> d;
  const hn::Rebind<std::int32_t, decltype(d)> d32;
  const hn::Rebind<std::int16_t, decltype(d)> d16;
  const std::size_t lanes = hn::Lanes(d);
  const WeightEntry* const in_steps = cache.entries + block.first;
  const WeightEntry* const in_float = in_steps + block.in_steps;
  const auto* const steps = reinterpret_cast<const std::int16_t*>(cache.weights + block.first_byte);
  const auto* const floats = reinterpret_cast<const float*>(steps + block.in_steps * block_size);
  const auto by_middles = moved_by_middles(in_steps, block.in_steps, pass.by);
  const Vectors3<hn::Vec<decltype(d)>> middles{hn::Set(d, by_middles[0]), hn::Set(d, by_middles[1]),
                                               hn::Set(d, by_middles[2])};
  for (std::size_t lane = 0; lane < block_size; lane += abreast * lanes) {
    Vectors3<hn::Vec<decltype(d)>> places[abreast];
    for (std::size_t n = 0; n < abreast; ++n)
      places[n] = load_vectors(d, pass.from[block.block], lane + n * lanes);
    for (std::size_t k = 0; k < block.in_steps; ++k) {
      const auto weight = [&](std::size_t n) HWY_ATTR {
        const auto number = hn::Load(d16, steps + k * block_size + lane + n * lanes);
        return hn::ConvertTo(d, hn::PromoteTo(d32, number));
      };
      add_weighted(d, pass.by_step[in_steps[k].start], weight, places);
    }
    for (std::size_t k = 0; k < block.in_float; ++k) {
      const auto weight = [&](std::size_t n) HWY_ATTR {
        return hn::Load(d, floats + k * block_size + lane + n * lanes);
      };
      add_weighted(d, pass.by[in_float[k].start], weight, places);
    }
    for (std::size_t n = 0; n < abreast; ++n) {
      VertexBlock& to = pass.to[block.block];
      const std::size_t at = lane + n * lanes;
      const auto moved = sum_of(places[n], middles);
      streams ? stream_vectors(d, moved, to, at) : store_vectors(d, moved, to, at);
    }
  }
}

void apply(const WeightCache& cache, const WeightPass& pass) {
  const bool streams = pass.large && pass.to != pass.from;
  for (std::size_t at = pass.begin; at < pass.end; ++at) {
    if (pass.large && at + fetched_ahead < cache.block_count)
      fetch(pass.from[cache.blocks[at + fetched_ahead].block]);
    apply_block(cache, cache.blocks[at], pass, streams);
  }
}

void bounds_into(const VertexBlock& block, BlockBounds& bounds) {
  bounds = vector_bounds(hn::ScalableTag<float>(), block);
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(apply);
HWY_EXPORT(bounds_into);

void apply_weights(const WeightCache& cache, const WeightPass& pass) noexcept {
  HWY_DYNAMIC_DISPATCH(apply)(cache, pass);
}

void update_bounds(const VertexBlock& block, BlockBounds& bounds) noexcept {
  HWY_DYNAMIC_DISPATCH(bounds_into)(block, bounds);
}

} // namespace nendo::deform
#endif
