// A field's value and its derivative at once: they share the distance, which is half of the work.

#include "simd/normal_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/normal_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"
#include "simd/lists-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The gradients of the three coordinates of x + s(x).
template <class V>
struct Gradients {
  Vectors3<V> x, y, z;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Gradients<V> gradients_without_centres(D d, const FieldView& field) {
  using Real = hn::TFromD<D>;
  const auto at = [&](std::size_t row, std::size_t axis) HWY_ATTR {
    const double tilt = field.polynomial != nullptr ? (*field.polynomial)[row][axis + 1] : 0.0;
    return hn::Set(d, static_cast<Real>(row == axis ? 1.0 + tilt : tilt));
  };
  return {{at(0, 0), at(0, 1), at(0, 2)},
          {at(1, 0), at(1, 1), at(1, 2)},
          {at(2, 0), at(2, 1), at(2, 2)}};
}

template <class D, class Real, class V = hn::Vec<D>>
HWY_INLINE void add_scaled(D d, const Vectors3<V>& vector, Real by, Vectors3<V>& sum) {
  const V factor = hn::Set(d, by);
  sum.x = hn::MulAdd(vector.x, factor, sum.x);
  sum.y = hn::MulAdd(vector.y, factor, sum.y);
  sum.z = hn::MulAdd(vector.z, factor, sum.z);
}

/// Adds the listed centres to the displacement, if that is wanted, and to the gradients.
template <Wendland kernel, bool moves, class D, class V = hn::Vec<D>>
HWY_INLINE void add_turning(D d, const FieldEntry<hn::TFromD<D>>* entries,
                            const std::uint32_t* list, std::size_t count, const Vectors3<V>& place,
                            Vectors3<V>& sum, Gradients<V>& gradients) {
  const V one = hn::Set(d, hn::TFromD<D>(1));
  for (std::size_t at = 0; at < count; ++at) {
    const auto& entry = entries[list[at]];
    const V x = hn::Sub(place.x, hn::Set(d, entry.x));
    const V y = hn::Sub(place.y, hn::Set(d, entry.y));
    const V z = hn::Sub(place.z, hn::Set(d, entry.z));
    const V squared = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const V distance = hn::Sqrt(squared);
    const V inverse = hn::Set(d, entry.inverse_radius);
    const V o = hn::Max(hn::NegMulAdd(distance, inverse, one), hn::Zero(d));
    if constexpr (moves) {
      const V w = weight<kernel>(d, o);
      sum.x = hn::MulAdd(w, hn::Set(d, entry.coefficient[0]), sum.x);
      sum.y = hn::MulAdd(w, hn::Set(d, entry.coefficient[1]), sum.y);
      sum.z = hn::MulAdd(w, hn::Set(d, entry.coefficient[2]), sum.z);
    }
    const V steep = slope<kernel>(d, hn::Mul(distance, inverse), o);
    const Vectors3<V> gradient{hn::Mul(steep, x), hn::Mul(steep, y), hn::Mul(steep, z)};
    add_scaled(d, gradient, entry.steep[0], gradients.x);
    add_scaled(d, gradient, entry.steep[1], gradients.y);
    add_scaled(d, gradient, entry.steep[2], gradients.z);
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
template <class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> turned(D d, const Gradients<V>& to, const Vectors3<V>& normal) {
  using Real = hn::TFromD<D>;
  const Vectors3<V> image{dot(cross(to.y, to.z), normal), dot(cross(to.z, to.x), normal),
                          dot(cross(to.x, to.y), normal)};
  const V squared = dot(image, image);
  // False for NaN, too.
  const auto usable =
      hn::And(hn::Ge(squared, hn::Set(d, Real(1e-30))), hn::Le(squared, hn::Set(d, Real(1e38))));
  const V scale = hn::Div(hn::Set(d, Real(1)), hn::Sqrt(squared));
  return {hn::IfThenElse(usable, hn::Mul(image.x, scale), normal.x),
          hn::IfThenElse(usable, hn::Mul(image.y, scale), normal.y),
          hn::IfThenElse(usable, hn::Mul(image.z, scale), normal.z)};
}

template <Wendland kernel, bool moves, class Real>
struct Turning {
  const FieldView& field;
  const FieldEntry<Real>* entries;
  const BlockPass& pass;
  const NormalPass& normals;

  HWY_INLINE void on_block(std::size_t block, const std::uint32_t* list, std::size_t size) {
    const bool reached = size > 0 || field.polynomial != nullptr;
    pass.reached[block] = reached ? 1 : 0;
    if (!reached) return;
    const hn::ScalableTag<Real> d;
    const Gradients<hn::Vec<decltype(d)>> alone = gradients_without_centres(d, field);
    for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
      const auto place = load_vectors(d, pass.from[block], lane);
      auto gradients = alone;
      const Vectors3<hn::Vec<decltype(d)>> none{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
      auto sum =
          moves && field.polynomial != nullptr ? polynomial_at(d, *field.polynomial, place) : none;
      add_turning<kernel, moves>(d, entries, list, size, place, sum, gradients);
      if constexpr (moves) store_vectors(d, sum_of(place, sum), pass.to[block], lane);
      const auto normal = load_vectors(d, normals.from[block], lane);
      store_vectors(d, turned(d, gradients, normal), normals.to[block], lane);
    }
    if (!moves || pass.new_bounds == nullptr) return;
    pass.new_bounds[block] = vector_bounds(hn::ScalableTag<float>(), pass.to[block]);
  }
};

template <Wendland kernel, class Real>
void turn_blocks(const FieldView& field, const FieldEntry<Real>* entries, const BlockPass& pass,
                 const NormalPass& normals) {
  if (pass.to != nullptr) {
    Turning<kernel, true, Real> work{field, entries, pass, normals};
    for_each_block(field.centres, pass, work);
  } else {
    Turning<kernel, false, Real> work{field, entries, pass, normals};
    for_each_block(field.centres, pass, work);
  }
}

template <Wendland kernel>
void turn_with(const FieldView& field, const BlockPass& pass, const NormalPass& normals) {
  if (field.precise_entries != nullptr) {
    turn_blocks<kernel>(field, field.precise_entries, pass, normals);
  } else {
    turn_blocks<kernel>(field, field.entries, pass, normals);
  }
}

void turn_any(const FieldView& field, const BlockPass& pass, const NormalPass& normals) {
  switch (field.kernel) {
  case Wendland::c0:
    return turn_with<Wendland::c0>(field, pass, normals);
  case Wendland::c2:
    return turn_with<Wendland::c2>(field, pass, normals);
  case Wendland::c4:
    return turn_with<Wendland::c4>(field, pass, normals);
  case Wendland::c6:
    return turn_with<Wendland::c6>(field, pass, normals);
  }
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(turn_any);

void displace_normals_pass(const FieldView& field, const BlockPass& pass,
                           const NormalPass& normals) noexcept {
  HWY_DYNAMIC_DISPATCH(turn_any)(field, pass, normals);
}

} // namespace nendo::deform
#endif
