// The Wendland functions in vectors. Included once for each instruction set (Highway's
// foreach_target).

#if defined(NENDO_SIMD_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_KERNELS_INL
#undef NENDO_SIMD_KERNELS_INL
#else
#define NENDO_SIMD_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "simd/field_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// psi / kernel_factor of o = 1 - t, which is not negative.
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

/// The bounds of a block that has just been written.
template <class D, class V = hn::Vec<D>>
HWY_INLINE BlockBounds vector_bounds(D d, const VertexBlock& block) {
  BlockBounds bounds;
  const float* const coordinates[3] = {block.x.data(), block.y.data(), block.z.data()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    V low = hn::Load(d, coordinates[axis]);
    V high = low;
    for (std::size_t lane = hn::Lanes(d); lane < block_size; lane += hn::Lanes(d)) {
      const V more = hn::Load(d, coordinates[axis] + lane);
      low = hn::Min(low, more);
      high = hn::Max(high, more);
    }
    bounds.sides[axis] = hn::GetLane(hn::MinOfLanes(d, low));
    bounds.sides[axis + 4] = -hn::GetLane(hn::MaxOfLanes(d, high));
  }
  bounds.sides[3] = bounds.sides[7] = 0.0F;
  return bounds;
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
