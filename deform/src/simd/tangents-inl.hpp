// How a field turns a normal by the images of two tangents, which are fewer sums than a Jacobian.
// Included once for each instruction set (Highway's foreach_target).

#if defined(NENDO_SIMD_TANGENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_TANGENTS_INL
#undef NENDO_SIMD_TANGENTS_INL
#else
#define NENDO_SIMD_TANGENTS_INL
#endif

#include <hwy/highway.h>

#include "simd/turning-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Two tangents, e_u - a e_w and e_v - b e_w, whose cross product is the normal divided by its
/// coordinate w: their images take two sums of vectors instead of the Jacobian's three.
template <int w, class V>
struct Tangents {
  static_assert(w >= 0 && w < 3);
  V a, b;

  HWY_INLINE static V axis(const Vectors3<V>& vector, int which) {
    return which % 3 == 0 ? vector.x : which % 3 == 1 ? vector.y : vector.z;
  }
  HWY_INLINE static V first(const Vectors3<V>& vector) { return axis(vector, w + 1); }
  HWY_INLINE static V second(const Vectors3<V>& vector) { return axis(vector, w + 2); }
  HWY_INLINE static V third(const Vectors3<V>& vector) { return axis(vector, w); }
};

/// Whether coordinate w is large enough in all normals of a vector for that; not if one is zero.
template <class D, class V = hn::Vec<D>>
HWY_INLINE bool has_tangents(D d, V w, V squared) {
  return hn::AllTrue(d, hn::Gt(hn::Mul(hn::Mul(w, w), hn::Set(d, 12.0F)), squared));
}

/// Without centres: the image of e_axis - share e_w.
template <int w, class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> tangent_along(D d, const FieldView& field, int axis, V share) {
  if (field.polynomial == nullptr) {
    const auto at = [&](int row) HWY_ATTR {
      return row == w ? hn::Neg(share) : hn::Set(d, row == axis ? 1.0F : 0.0F);
    };
    return {at(0), at(1), at(2)};
  }
  const Vectors3<V> by_axis = polynomial_along(d, field, static_cast<std::size_t>(axis));
  const Vectors3<V> by_w = polynomial_along(d, field, w);
  return {hn::NegMulAdd(share, by_w.x, by_axis.x), hn::NegMulAdd(share, by_w.y, by_axis.y),
          hn::NegMulAdd(share, by_w.z, by_axis.z)};
}

/// As add_turning() and by_cofactors(), in float: gives the normal's image.
template <Wendland kernel, int w, class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> add_tangents(D d, bool moves, const FieldView& field,
                                    const FieldEntry<float>* entries, const std::uint32_t* list,
                                    std::size_t count, TurningVector<V>& at) {
  using T = Tangents<w, V>;
  const V length = T::third(at.normal);
  const V inverse = inverse_of(d, length);
  const T tangents{hn::Mul(T::first(at.normal), inverse), hn::Mul(T::second(at.normal), inverse)};
  Vectors3<V> first = tangent_along<w>(d, field, (w + 1) % 3, tangents.a);
  Vectors3<V> second = tangent_along<w>(d, field, (w + 2) % 3, tangents.b);
  const auto add = [&](const FieldEntry<float>& entry, V distance) HWY_ATTR {
    const Pull<V> pull = pull_at<kernel>(d, entry, at.place, distance);
    if (moves) add_scaled(d, entry.coefficient, pull.weight, at.sum);
    const V third = T::third(pull.offset);
    const V along_first = hn::NegMulAdd(tangents.a, third, T::first(pull.offset));
    const V along_second = hn::NegMulAdd(tangents.b, third, T::second(pull.offset));
    add_scaled(d, entry.steep, hn::Mul(pull.slope, along_first), first);
    add_scaled(d, entry.steep, hn::Mul(pull.slope, along_second), second);
  };
  for_each_centre(d, entries, list, count, at.place, at.distance, add);
  const Vectors3<V> image = cross(first, second);
  return {hn::Mul(image.x, length), hn::Mul(image.y, length), hn::Mul(image.z, length)};
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
