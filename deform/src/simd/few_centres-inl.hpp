// How one or two centres turn a normal: by identities for what differs from the identity by a
// matrix of that rank, without tangents.
// Included once for each instruction set (Highway's foreach_target).

#if defined(NENDO_SIMD_FEW_CENTRES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef NENDO_SIMD_FEW_CENTRES_INL
#undef NENDO_SIMD_FEW_CENTRES_INL
#else
#define NENDO_SIMD_FEW_CENTRES_INL
#endif

#include <array>

#include <hwy/highway.h>

#include "simd/turning-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class Real, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> everywhere(D d, const std::array<Real, 3>& vector) {
  return {hn::Set(d, vector[0]), hn::Set(d, vector[1]), hn::Set(d, vector[2])};
}

/// As add_turning() and by_cofactors() for a single centre. The Jacobian is I + u g^T, with its
/// steep coefficient u and the gradient g = slope * offset, and its cofactors take n to
/// (1 + g u) n - (u n) g.
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> turned_by_one(D d, bool moves, const FieldEntry<hn::TFromD<D>>& entry,
                                     TurningVector<V>& at) {
  const Pull<V> pull = pull_at<kernel>(d, entry, at.place, distance_to(d, entry, at.place));
  if (moves) add_scaled(d, entry.coefficient, pull.weight, at.sum);
  const Vectors3<V> u = everywhere(d, entry.steep);
  const V keeps = hn::MulAdd(pull.slope, dot(u, pull.offset), hn::Set(d, 1));
  const V tilts = hn::Mul(pull.slope, dot(u, at.normal));
  const auto turned = [&](V offset, V normal)
                          HWY_ATTR { return hn::NegMulAdd(tilts, offset, hn::Mul(keeps, normal)); };
  return {turned(pull.offset.x, at.normal.x), turned(pull.offset.y, at.normal.y),
          turned(pull.offset.z, at.normal.z)};
}

/// The same for two: I + U G^T with two columns each. With M = I + G^T U, its cofactors take n to
/// det(M) n - G adj(M)^T U^T n.
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE Vectors3<V> turned_by_two(D d, bool moves, const FieldEntry<hn::TFromD<D>>& one,
                                     const FieldEntry<hn::TFromD<D>>& two, TurningVector<V>& at) {
  const V to_one = distance_to(d, one, at.place);
  const V to_two = distance_to(d, two, at.place);
  const Pull<V> a = pull_at<kernel>(d, one, at.place, to_one);
  const Pull<V> b = pull_at<kernel>(d, two, at.place, to_two);
  if (moves) {
    add_scaled(d, one.coefficient, a.weight, at.sum);
    add_scaled(d, two.coefficient, b.weight, at.sum);
  }
  const Vectors3<V> u = everywhere(d, one.steep);
  const Vectors3<V> v = everywhere(d, two.steep);
  const V au = hn::MulAdd(a.slope, dot(u, a.offset), hn::Set(d, 1));
  const V av = hn::Mul(a.slope, dot(v, a.offset));
  const V bu = hn::Mul(b.slope, dot(u, b.offset));
  const V bv = hn::MulAdd(b.slope, dot(v, b.offset), hn::Set(d, 1));
  const V along_u = dot(u, at.normal);
  const V along_v = dot(v, at.normal);
  const V keeps = hn::NegMulAdd(av, bu, hn::Mul(au, bv));
  const V tilts_a = hn::Mul(a.slope, hn::NegMulAdd(bu, along_v, hn::Mul(bv, along_u)));
  const V tilts_b = hn::Mul(b.slope, hn::NegMulAdd(av, along_u, hn::Mul(au, along_v)));
  const auto turned = [&](V from_one, V from_two, V normal) HWY_ATTR {
    return hn::NegMulAdd(tilts_b, from_two,
                         hn::NegMulAdd(tilts_a, from_one, hn::Mul(keeps, normal)));
  };
  return {turned(a.offset.x, b.offset.x, at.normal.x), turned(a.offset.y, b.offset.y, at.normal.y),
          turned(a.offset.z, b.offset.z, at.normal.z)};
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
