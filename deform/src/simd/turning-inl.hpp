// How a field turns a normal: by the cofactors of its Jacobian, or by the images of two tangents.
// Included once for each instruction set (Highway's foreach_target).

#if defined(NENDO_SIMD_TURNING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_TURNING_INL
#undef NENDO_SIMD_TURNING_INL
#else
#define NENDO_SIMD_TURNING_INL
#endif

#include <array>

#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The derivatives of x + s(x) along the axes: the Jacobian's columns.
template <class V>
struct Gradients {
  Vectors3<V> along_x, along_y, along_z;
};

/// Without centres.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> polynomial_along(D d, const FieldView& field, std::size_t axis) {
  using Real = hn::TFromD<D>;
  const auto at = [&](std::size_t row) HWY_ATTR {
    const double tilt = field.polynomial != nullptr ? (*field.polynomial)[row][axis + 1] : 0.0;
    return hn::Set(d, static_cast<Real>(row == axis ? 1.0 + tilt : tilt));
  };
  return {at(0), at(1), at(2)};
}

/// sum += vector * by.
template <class D, class Real, class V = hn::Vec<D>>
HWY_INLINE void add_scaled(D d, const std::array<Real, 3>& vector, V by, Vectors3<V>& sum) {
  sum.x = hn::MulAdd(by, hn::Set(d, vector[0]), sum.x);
  sum.y = hn::MulAdd(by, hn::Set(d, vector[1]), sum.y);
  sum.z = hn::MulAdd(by, hn::Set(d, vector[2]), sum.z);
}

/// What a centre does at a place: how far off it is, on each axis, psi and psi' / t.
template <class V>
struct Pull {
  Vectors3<V> offset;
  V weight, slope;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> offset_from(D d, const FieldEntry<hn::TFromD<D>>& entry,
                                   const Vectors3<V>& place) {
  return {hn::Sub(place.x, hn::Set(d, entry.x)), hn::Sub(place.y, hn::Set(d, entry.y)),
          hn::Sub(place.z, hn::Set(d, entry.z))};
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V distance_to(D d, const FieldEntry<hn::TFromD<D>>& entry, const Vectors3<V>& place) {
  const auto [x, y, z] = offset_from(d, entry, place);
  return hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
}

template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE Pull<V> pull_at(D d, const FieldEntry<hn::TFromD<D>>& entry, const Vectors3<V>& place,
                           V distance) {
  const V o = depth<kernel>(d, entry, distance);
  return {offset_from(d, entry, place), weight_at<kernel>(d, entry, o),
          slope<kernel>(d, distance, o)};
}

/// Adds the listed centres to the displacement, if that is wanted, and to the gradients.
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE void add_turning(D d, bool moves, const FieldEntry<hn::TFromD<D>>* entries,
                            const std::uint32_t* list, std::size_t count, const Vectors3<V>& place,
                            Vectors3<V>& sum, Gradients<V>& gradients) {
  for (std::size_t at = 0; at < count; ++at) {
    const auto& entry = entries[list[at]];
    const Pull<V> pull = pull_at<kernel>(d, entry, place, distance_to(d, entry, place));
    if (moves) add_scaled(d, entry.coefficient, pull.weight, sum);
    const auto& [x, y, z] = pull.offset;
    add_scaled(d, entry.steep, hn::Mul(pull.slope, x), gradients.along_x);
    add_scaled(d, entry.steep, hn::Mul(pull.slope, y), gradients.along_y);
    add_scaled(d, entry.steep, hn::Mul(pull.slope, z), gradients.along_z);
  }
}

template <class V>
HWY_INLINE V dot(const Vectors3<V>& a, const Vectors3<V>& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

template <class V>
HWY_INLINE Vectors3<V> cross(const Vectors3<V>& a, const Vectors3<V>& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}

/// The cofactors of the Jacobian take the cross product of two tangents to that of their images.
template <class V>
HWY_INLINE Vectors3<V> by_cofactors(const Gradients<V>& columns, const Vectors3<V>& normal) {
  const Vectors3<V> x = cross(columns.along_y, columns.along_z);
  const Vectors3<V> y = cross(columns.along_z, columns.along_x);
  const Vectors3<V> z = cross(columns.along_x, columns.along_y);
  const auto row = [&](V a, V b, V c) HWY_ATTR {
    return hn::MulAdd(a, normal.x, hn::MulAdd(b, normal.y, hn::Mul(c, normal.z)));
  };
  return {row(x.x, y.x, z.x), row(x.y, y.y, z.y), row(x.z, y.z, z.z)};
}

/// An image of a normal, of unit length; the normal itself where that has none.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> normalised(D d, const Vectors3<V>& image, const Vectors3<V>& normal) {
  using Real = hn::TFromD<D>;
  const V squared = dot(image, image);
  // False for NaN, too.
  const auto usable =
      hn::And(hn::Ge(squared, hn::Set(d, Real(1e-30))), hn::Le(squared, hn::Set(d, Real(1e38))));
  const V scale = hn::Div(hn::Set(d, Real(1)), hn::Sqrt(squared));
  return {hn::IfThenElse(usable, hn::Mul(image.x, scale), normal.x),
          hn::IfThenElse(usable, hn::Mul(image.y, scale), normal.y),
          hn::IfThenElse(usable, hn::Mul(image.z, scale), normal.z)};
}

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

/// Whether coordinate w is large enough in all normals of a vector for that.
template <class D, class V = hn::Vec<D>>
HWY_INLINE bool has_tangents(D d, V w, V squared) {
  using Real = hn::TFromD<D>;
  return hn::AllTrue(d, hn::Ge(hn::Mul(hn::Mul(w, w), hn::Set(d, Real(12))), squared));
}

/// As add_turning() and by_cofactors(): gives the normal's image.
template <Wendland kernel, int w, class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V>
add_tangents(D d, bool moves, const FieldView& field, const FieldEntry<hn::TFromD<D>>* entries,
             const std::uint32_t* list, std::size_t count, const Vectors3<V>& place,
             const Vectors3<V>& normal, Vectors3<V>& sum) {
  using T = Tangents<w, V>;
  const V inverse = hn::Div(hn::Set(d, hn::TFromD<D>(1)), T::third(normal));
  const T tangents{hn::Mul(T::first(normal), inverse), hn::Mul(T::second(normal), inverse)};
  const Vectors3<V> along_w = polynomial_along(d, field, w);
  const auto without_centres = [&](std::size_t axis, V share) HWY_ATTR {
    const Vectors3<V> along = polynomial_along(d, field, axis % 3);
    return Vectors3<V>{hn::NegMulAdd(share, along_w.x, along.x),
                       hn::NegMulAdd(share, along_w.y, along.y),
                       hn::NegMulAdd(share, along_w.z, along.z)};
  };
  Vectors3<V> first = without_centres(w + 1, tangents.a);
  Vectors3<V> second = without_centres(w + 2, tangents.b);
  const auto add = [&](const FieldEntry<hn::TFromD<D>>& entry, V distance) HWY_ATTR {
    const Pull<V> pull = pull_at<kernel>(d, entry, place, distance);
    if (moves) add_scaled(d, entry.coefficient, pull.weight, sum);
    const V third = T::third(pull.offset);
    const V along_first = hn::NegMulAdd(tangents.a, third, T::first(pull.offset));
    const V along_second = hn::NegMulAdd(tangents.b, third, T::second(pull.offset));
    add_scaled(d, entry.steep, hn::Mul(pull.slope, along_first), first);
    add_scaled(d, entry.steep, hn::Mul(pull.slope, along_second), second);
  };
  if (count > 0) { // one centre's root while the one before it is added
    V distance = distance_to(d, entries[list[0]], place);
    for (std::size_t at = 1; at < count; ++at) {
      const V next = distance_to(d, entries[list[at]], place);
      add(entries[list[at - 1]], distance);
      distance = next;
    }
    add(entries[list[count - 1]], distance);
  }
  const Vectors3<V> image = cross(first, second);
  const V length = T::third(normal);
  return {hn::Mul(image.x, length), hn::Mul(image.y, length), hn::Mul(image.z, length)};
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
