// How a field turns a normal: by the cofactors of its Jacobian.
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

/// Calls add(entry, distance) for the listed centres; `distance` is the first one's. One centre's
/// root is taken while the one before it is added.
template <class D, class Add, class V = hn::Vec<D>>
HWY_INLINE void for_each_centre(D d, const FieldEntry<hn::TFromD<D>>* entries,
                                const std::uint32_t* list, std::size_t count,
                                const Vectors3<V>& place, V distance, const Add& add) {
  if (count == 0) return;
  for (std::size_t at = 1; at < count; ++at) {
    const V next = distance_to(d, entries[list[at]], place);
    add(entries[list[at - 1]], distance);
    distance = next;
  }
  add(entries[list[count - 1]], distance);
}

/// A vector of vertices on its way through the centres.
template <class V>
struct TurningVector {
  Vectors3<V> place, normal;
  V distance;      ///< to the first centre
  Vectors3<V> sum; ///< of displacements
};

/// Adds the listed centres to the displacement, if that is wanted, and to the gradients.
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE void add_turning(D d, bool moves, const FieldEntry<hn::TFromD<D>>* entries,
                            const std::uint32_t* list, std::size_t count, TurningVector<V>& at,
                            Gradients<V>& gradients) {
  const auto add = [&](const FieldEntry<hn::TFromD<D>>& entry, V distance) HWY_ATTR {
    const Pull<V> pull = pull_at<kernel>(d, entry, at.place, distance);
    if (moves) add_scaled(d, entry.coefficient, pull.weight, at.sum);
    const auto& [x, y, z] = pull.offset;
    add_scaled(d, entry.steep, hn::Mul(pull.slope, x), gradients.along_x);
    add_scaled(d, entry.steep, hn::Mul(pull.slope, y), gradients.along_y);
    add_scaled(d, entry.steep, hn::Mul(pull.slope, z), gradients.along_z);
  };
  for_each_centre(d, entries, list, count, at.place, at.distance, add);
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

/// x86 estimates to eleven bits and more, which a step of Newton's takes to nearly all of
/// float's.
constexpr bool has_estimates = HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR;

template <class D, class V = hn::Vec<D>>
HWY_INLINE V inverse_of(D d, V x) {
  const V one = hn::Set(d, 1.0F);
  if constexpr (!has_estimates) return hn::Div(one, x);
  const V y = hn::ApproximateReciprocal(x);
  return hn::MulAdd(y, hn::NegMulAdd(x, y, one), y);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V inverse_root_of(D d, V x) {
  if constexpr (!has_estimates) return hn::Div(hn::Set(d, 1.0F), hn::Sqrt(x));
  const V y = hn::ApproximateReciprocalSqrt(x);
  const V half = hn::Mul(hn::Mul(x, hn::Set(d, 0.5F)), y);
  return hn::Mul(y, hn::NegMulAdd(half, y, hn::Set(d, 1.5F)));
}

/// Images of normals, to unit length; a normal itself where its image has none. A pass of its own
/// over the block: its steps wait for each other, but not for those of the next vector.
static HWY_NOINLINE void normalise(const VertexBlock& images, const VertexBlock& normals,
                                   VertexBlock& to) {
  const hn::ScalableTag<float> d;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto image = load_vectors(d, images, lane);
    const auto normal = load_vectors(d, normals, lane);
    const auto squared = dot(image, image);
    // False for NaN, too.
    const auto usable =
        hn::And(hn::Ge(squared, hn::Set(d, 1e-30F)), hn::Le(squared, hn::Set(d, 1e38F)));
    const auto scale = inverse_root_of(d, squared);
    const Vectors3<hn::Vec<decltype(d)>> unit{
        hn::IfThenElse(usable, hn::Mul(image.x, scale), normal.x),
        hn::IfThenElse(usable, hn::Mul(image.y, scale), normal.y),
        hn::IfThenElse(usable, hn::Mul(image.z, scale), normal.z)};
    store_vectors(d, unit, to, lane);
  }
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
