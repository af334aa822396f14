#include "simd/weight_kernels.hpp"

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
  const hn::Rebind<float, decltype(d)> df;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto x =
        hn::Sub(hn::PromoteTo(d, hn::Load(df, block.x.data() + lane)), hn::Set(d, entry.x));
    const auto y =
        hn::Sub(hn::PromoteTo(d, hn::Load(df, block.y.data() + lane)), hn::Set(d, entry.y));
    const auto z =
        hn::Sub(hn::PromoteTo(d, hn::Load(df, block.z.data() + lane)), hn::Set(d, entry.z));
    const auto squared = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto o =
        hn::NegMulAdd(hn::Sqrt(squared), hn::Set(d, entry.inverse_radius), hn::Set(d, 1.0));
    hn::Store(weight<kernel>(d, hn::Max(o, hn::Zero(d))), d, values + lane);
  }
}

HWY_INLINE void kernel_of(Wendland kernel, const FieldEntry<double>& entry,
                          const VertexBlock& block, double* values) {
  switch (kernel) {
  case Wendland::c0:
    return kernel_at<Wendland::c0>(entry, block, values);
  case Wendland::c2:
    return kernel_at<Wendland::c2>(entry, block, values);
  case Wendland::c4:
    return kernel_at<Wendland::c4>(entry, block, values);
  case Wendland::c6:
    return kernel_at<Wendland::c6>(entry, block, values);
  }
}

/// Start point j's weights in a block, stored at `weights`; gives the largest.
HWY_INLINE double weights_of(const WeightSource& source, std::size_t j, const std::uint32_t* list,
                             std::size_t count, const VertexBlock& block, float* weights) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> df;
  auto largest = hn::Zero(d);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    if (source.polynomial != nullptr) {
      const double* const p = source.polynomial + 4 * j;
      const auto x = hn::PromoteTo(d, hn::Load(df, block.x.data() + lane));
      const auto y = hn::PromoteTo(d, hn::Load(df, block.y.data() + lane));
      const auto z = hn::PromoteTo(d, hn::Load(df, block.z.data() + lane));
      sum = hn::MulAdd(z, hn::Set(d, p[3]), hn::Set(d, p[0]));
      sum = hn::MulAdd(y, hn::Set(d, p[2]), hn::MulAdd(x, hn::Set(d, p[1]), sum));
    }
    for (std::size_t at = 0; at < count; ++at)
      sum = hn::MulAdd(hn::Load(d, source.room_for_kernels + at * block_size + lane),
                       hn::Set(d, source.map[list[at] * source.starts + j]), sum);
    hn::Store(hn::DemoteTo(df, sum), df, weights + lane);
    largest = hn::Max(largest, hn::Abs(sum));
  }
  return hn::GetLane(hn::MaxOfLanes(d, largest));
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
    for (std::size_t at = 0; at < size; ++at)
      kernel_of(field.kernel, field.precise_entries[list[at]], pass.from[block],
                source.room_for_kernels + at * block_size);
    WeightedBlock& made = cache.blocks[cache.block_count];
    made = {static_cast<std::uint32_t>(block), 0, cache.used};
    for (std::size_t j = 0; j < source.starts; ++j) {
      done = cache.used < cache.room;
      if (!done) return;
      const double largest = weights_of(source, j, list, size, pass.from[block],
                                        cache.weights + cache.used * block_size);
      done = largest <= most_units; // false for NaN
      if (!done) return;
      if (largest <= static_cast<double>(source.least)) continue;
      cache.largest = largest > cache.largest ? largest : cache.largest;
      cache.starts[cache.used++] = static_cast<std::uint16_t>(j);
      ++made.count;
    }
    if (made.count == 0) return;
    pass.reached[block] = 1;
    ++cache.block_count;
  }
};

bool build(const FieldView& field, const BlockPass& pass, const WeightSource& source,
           WeightCache& cache) {
  cache.block_count = 0;
  cache.used = 0;
  cache.largest = 0.0;
  WeightBuild work{field, pass, source, cache};
  for_each_block(field.centres, pass, work);
  return work.done;
}

/// Four vectors at a time: twelve sums fit the registers of every instruction set.
void apply(const WeightCache& cache, std::size_t begin, std::size_t end,
           const std::array<float, 4>* displacements, const VertexBlock* from, VertexBlock* to) {
  const hn::ScalableTag<float> d;
  using V = hn::Vec<decltype(d)>;
  constexpr std::size_t abreast = 4;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t at = begin; at < end; ++at) {
    const WeightedBlock& block = cache.blocks[at];
    const VertexBlock& source = from[block.block];
    VertexBlock& target = to[block.block];
    const std::uint16_t* const starts = cache.starts + block.first;
    for (std::size_t lane = 0; lane < block_size; lane += abreast * lanes) {
      V x[abreast];
      V y[abreast];
      V z[abreast];
      for (std::size_t n = 0; n < abreast; ++n) {
        x[n] = hn::Load(d, source.x.data() + lane + n * lanes);
        y[n] = hn::Load(d, source.y.data() + lane + n * lanes);
        z[n] = hn::Load(d, source.z.data() + lane + n * lanes);
      }
      const float* weights = cache.weights + block.first * block_size + lane;
      for (std::uint32_t k = 0; k < block.count; ++k, weights += block_size) {
        const std::array<float, 4>& by = displacements[starts[k]];
        const V by_x = hn::Set(d, by[0]);
        const V by_y = hn::Set(d, by[1]);
        const V by_z = hn::Set(d, by[2]);
        for (std::size_t n = 0; n < abreast; ++n) {
          const V w = hn::Load(d, weights + n * lanes);
          x[n] = hn::MulAdd(w, by_x, x[n]);
          y[n] = hn::MulAdd(w, by_y, y[n]);
          z[n] = hn::MulAdd(w, by_z, z[n]);
        }
      }
      for (std::size_t n = 0; n < abreast; ++n) {
        hn::Store(x[n], d, target.x.data() + lane + n * lanes);
        hn::Store(y[n], d, target.y.data() + lane + n * lanes);
        hn::Store(z[n], d, target.z.data() + lane + n * lanes);
      }
    }
  }
}

void bounds_into(const VertexBlock& block, BlockBounds& bounds) {
  bounds = vector_bounds(hn::ScalableTag<float>(), block);
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(build);
HWY_EXPORT(apply);
HWY_EXPORT(bounds_into);

bool build_weights(const FieldView& field, const BlockPass& pass, const WeightSource& source,
                   WeightCache& cache) noexcept {
  return HWY_DYNAMIC_DISPATCH(build)(field, pass, source, cache);
}

void apply_weights(const WeightCache& cache, std::size_t begin, std::size_t end,
                   const std::array<float, 4>* displacements, const VertexBlock* from,
                   VertexBlock* to) noexcept {
  HWY_DYNAMIC_DISPATCH(apply)(cache, begin, end, displacements, from, to);
}

void update_bounds(const VertexBlock& block, BlockBounds& bounds) noexcept {
  HWY_DYNAMIC_DISPATCH(bounds_into)(block, bounds);
}

} // namespace nendo::deform
#endif
