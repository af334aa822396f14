// Type-1's weights: made in double when the start points are frozen, and applied each frame.

#include "simd/weight_kernels.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/weight_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"
#include "simd/lists-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One centre's kernel at all vertices of a block, in double.
template <Wendland kernel>
HWY_INLINE void kernel_at(const FieldEntry<double>& entry, const VertexBlock& block,
                          double* values) {
  const hn::ScalableTag<double> d;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto way = relative_to(d, entry, load_vectors(d, block, lane));
    const auto distance = hn::Sqrt(dot_product(way, way));
    const auto o = hn::NegMulAdd(distance, hn::Set(d, entry.inverse_radius), hn::Set(d, 1.0));
    hn::Store(weight<kernel>(d, hn::Max(o, hn::Zero(d))), d, values + lane);
  }
}

/// Start point j's weights in a block, stored at `weights`; gives the largest.
HWY_INLINE double weights_of(const WeightSource& source, std::size_t j, const std::uint32_t* list,
                             std::size_t count, const VertexBlock& block, float* weights) {
  const hn::ScalableTag<double> d;
  auto largest = hn::Zero(d);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    if (source.polynomial != nullptr) {
      const double* const p = source.polynomial + 4 * j;
      const auto place = load_vectors(d, block, lane);
      sum = hn::MulAdd(place.z, hn::Set(d, p[3]), hn::Set(d, p[0]));
      sum = hn::MulAdd(place.y, hn::Set(d, p[2]), hn::MulAdd(place.x, hn::Set(d, p[1]), sum));
    }
    for (std::size_t at = 0; at < count; ++at)
      sum = hn::MulAdd(hn::Load(d, source.kernel_scratch + at * block_size + lane),
                       hn::Set(d, source.map[list[at] * source.starts + j]), sum);
    store_from(d, sum, weights + lane);
    largest = hn::Max(largest, hn::Abs(sum));
  }
  return hn::GetLane(hn::MaxOfLanes(d, largest));
}

/// What steps of these weights count from; NaN if they are too far apart, or one of them is 0 and
/// another too far from it.
HWY_INLINE float middle_of(const float* weights) {
  const hn::ScalableTag<float> d;
  auto least = hn::Load(d, weights);
  auto most = least;
  auto nearest = hn::Abs(least); // to zero
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto w = hn::Load(d, weights + lane);
    least = hn::Min(least, w);
    most = hn::Max(most, w);
    nearest = hn::Min(nearest, hn::Abs(w));
  }
  const float lowest = hn::GetLane(hn::MinOfLanes(d, least));
  const float highest = hn::GetLane(hn::MaxOfLanes(d, most));
  const bool has_zero = hn::GetLane(hn::MinOfLanes(d, nearest)) == 0.0F;
  const float middle = has_zero ? 0.0F : 0.5F * (lowest + highest);
  const bool near = highest - middle <= max_from_middle && middle - lowest <= max_from_middle;
  return near ? middle : std::numeric_limits<float>::quiet_NaN();
}

HWY_INLINE void store_steps(const float* weights, float middle, std::byte* to) {
  const hn::ScalableTag<float> d;
  const hn::Rebind<std::int16_t, decltype(d)> d16;
  auto* const steps = reinterpret_cast<std::int16_t*>(to);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto from_middle = hn::Sub(hn::Load(d, weights + lane), hn::Set(d, middle));
    const auto number = hn::NearestInt(hn::Mul(from_middle, hn::Set(d, 1.0F / weight_step)));
    hn::Store(hn::DemoteTo(d16, number), d16, steps + lane);
  }
}

struct WeightBuild {
  const FieldView& field;
  const BlockPass& pass;
  const WeightSource& source;
  WeightCache& cache;
  bool done = true;

  HWY_INLINE void on_block(std::size_t block, const std::uint32_t* list, std::size_t size) {
    pass.reached[block] = 0;
    if (!done || (size == 0 && source.polynomial == nullptr)) return;
    with_kernel(field.kernel, [&](auto kernel) HWY_ATTR {
      for (std::size_t at = 0; at < size; ++at)
        kernel_at<kernel.value>(field.precise_entries[list[at]], pass.from[block],
                                source.kernel_scratch + at * block_size);
    });
    WeightedBlock& made = cache.blocks[cache.block_count];
    made = {static_cast<std::uint32_t>(block), 0, 0, cache.used_entries, cache.used_bytes};
    done = weigh(list, size, pass.from[block], made);
    if (!done || made.in_steps + made.in_float == 0) return;
    pass.reached[block] = 1;
    ++cache.block_count;
  }

  /// False if memory is exhausted, or a weight is not finite.
  HWY_INLINE bool weigh(const std::uint32_t* list, std::size_t size, const VertexBlock& vertices,
                        WeightedBlock& made) {
    std::array<WeightEntry, max_weighted_starts> entries;
    std::size_t count = 0;
    for (std::size_t j = 0; j < source.starts; ++j) {
      float* const weights = source.weight_scratch + count * block_size;
      const double largest = weights_of(source, j, list, size, vertices, weights);
      if (!(largest <= max_units)) return false; // NaN, too
      if (largest <= static_cast<double>(source.least)) continue;
      cache.largest = largest > cache.largest ? largest : cache.largest;
      entries[count++] = {static_cast<std::uint32_t>(j), middle_of(weights)};
    }
    if (cache.used_entries + count > cache.max_entries) return false;
    for (const bool in_steps : {true, false})
      for (std::size_t at = 0; at < count; ++at)
        if (std::isnan(entries[at].middle) != in_steps &&
            !keep(entries[at], source.weight_scratch + at * block_size, in_steps, made))
          return false;
    return true;
  }

  HWY_INLINE bool keep(WeightEntry entry, const float* weights, bool in_steps,
                       WeightedBlock& made) {
    const std::size_t bytes = in_steps ? bytes_in_steps : bytes_in_float;
    if (cache.used_bytes + bytes > cache.max_bytes) return false;
    std::byte* const to = cache.weights + cache.used_bytes;
    if (in_steps) {
      store_steps(weights, entry.middle, to);
      ++made.in_steps;
    } else {
      std::memcpy(to, weights, bytes);
      entry.middle = 0.0F;
      ++made.in_float;
    }
    cache.entries[cache.used_entries++] = entry;
    cache.used_bytes += bytes;
    return true;
  }
};

bool build(const FieldView& field, const BlockPass& pass, const WeightSource& source,
           WeightCache& cache) {
  cache.block_count = 0;
  cache.used_entries = 0;
  cache.used_bytes = 0;
  cache.largest = 0.0;
  WeightBuild work{field, pass, source, cache};
  for_each_block(field.centres, pass, work);
  return work.done;
}

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

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(build);
HWY_EXPORT(apply);

bool build_weights(const FieldView& field, const BlockPass& pass, const WeightSource& source,
                   WeightCache& cache) noexcept {
  return HWY_DYNAMIC_DISPATCH(build)(field, pass, source, cache);
}

void apply_weights(const WeightCache& cache, const WeightPass& pass) noexcept {
  HWY_DYNAMIC_DISPATCH(apply)(cache, pass);
}

} // namespace nendo::deform
#endif
