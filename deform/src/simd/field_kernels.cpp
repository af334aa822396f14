// Evaluation of a field on blocks: for each block the centres that reach it, then for each vector
// of vertices all of those, so that sums stay in registers. `nendo bench deform` measures the
// cost.

#include "simd/field_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/field_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"
#include "simd/lists-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of vertices that go through the centres together: as many as the registers hold.
constexpr std::size_t abreast = HWY_MAX_BYTES >= 64 ? 4 : HWY_TARGET == HWY_SCALAR ? 1 : 2;

template <class D, class V = hn::Vec<D>>
HWY_INLINE void distances_to(D d, const FieldEntry<hn::TFromD<D>>& entry,
                             const Vectors3<V> (&places)[abreast], V (&distances)[abreast]) {
  for (std::size_t n = 0; n < abreast; ++n) {
    const Vectors3<V> way = relative_to(d, entry, places[n]);
    distances[n] = hn::Sqrt(dot_product(way, way));
  }
}

template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE void add_entry(D d, const FieldEntry<hn::TFromD<D>>& entry,
                          const V (&distances)[abreast], Vectors3<V> (&sums)[abreast]) {
  for (std::size_t n = 0; n < abreast; ++n) {
    const V w = weight_at<kernel>(d, entry, depth<kernel>(d, entry, distances[n]));
    sums[n].x = hn::MulAdd(w, hn::Set(d, entry.coefficient[0]), sums[n].x);
    sums[n].y = hn::MulAdd(w, hn::Set(d, entry.coefficient[1]), sums[n].y);
    sums[n].z = hn::MulAdd(w, hn::Set(d, entry.coefficient[2]), sums[n].z);
  }
}

/// Adds the field of the listed centres at the places. One centre's roots are taken while the one
/// before it is added: a root takes longer than processors look ahead.
template <Wendland kernel, class D, class V = hn::Vec<D>>
HWY_INLINE void add_entries(D d, const FieldEntry<hn::TFromD<D>>* entries,
                            const std::uint32_t* list, std::size_t count,
                            const Vectors3<V> (&places)[abreast], Vectors3<V> (&sums)[abreast]) {
  if (count == 0) return;
  V distances[abreast];
  distances_to(d, entries[list[0]], places, distances);
  for (std::size_t at = 1; at < count; ++at) {
    V next[abreast];
    distances_to(d, entries[list[at]], places, next);
    add_entry<kernel>(d, entries[list[at - 1]], distances, sums);
    for (std::size_t n = 0; n < abreast; ++n)
      distances[n] = next[n];
  }
  add_entry<kernel>(d, entries[list[count - 1]], distances, sums);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void load_places(D d, const VertexBlock& from, std::size_t lane,
                            Vectors3<V> (&places)[abreast]) {
  for (std::size_t n = 0; n < abreast; ++n)
    places[n] = load_vectors(d, from, lane + n * hn::Lanes(d));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void store_places(D d, const Vectors3<V> (&places)[abreast], VertexBlock& to,
                             std::size_t lane, bool streams) {
  for (std::size_t n = 0; n < abreast; ++n) {
    const std::size_t at = lane + n * hn::Lanes(d);
    streams ? stream_vectors(d, places[n], to, at) : store_vectors(d, places[n], to, at);
  }
}

/// What a single centre does is added to the places themselves: nothing is summed before.
template <Wendland kernel, class Real>
HWY_INLINE void displace_block_by_one(const FieldEntry<Real>& entry, const VertexBlock& from,
                                      VertexBlock& to, bool streams) {
  const hn::ScalableTag<Real> d;
  using V = hn::Vec<decltype(d)>;
  for (std::size_t lane = 0; lane < block_size; lane += abreast * hn::Lanes(d)) {
    Vectors3<V> places[abreast];
    V distances[abreast];
    load_places(d, from, lane, places);
    distances_to(d, entry, places, distances);
    add_entry<kernel>(d, entry, distances, places);
    store_places(d, places, to, lane, streams);
  }
}

template <Wendland kernel, class Real>
HWY_INLINE void displace_block(const FieldView& field, const FieldEntry<Real>* entries,
                               const std::uint32_t* list, std::size_t size, const VertexBlock& from,
                               VertexBlock& to, bool streams) {
  const hn::ScalableTag<Real> d;
  using V = hn::Vec<decltype(d)>;
  for (std::size_t lane = 0; lane < block_size; lane += abreast * hn::Lanes(d)) {
    Vectors3<V> places[abreast];
    Vectors3<V> sums[abreast];
    load_places(d, from, lane, places);
    for (std::size_t n = 0; n < abreast; ++n) {
      sums[n] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
      if (field.polynomial == nullptr) continue;
      sums[n] = polynomial_at(d, *field.polynomial, places[n]);
    }
    add_entries<kernel>(d, entries, list, size, places, sums);
    for (std::size_t n = 0; n < abreast; ++n)
      places[n] = sum_of(places[n], sums[n]);
    store_places(d, places, to, lane, streams);
  }
}

/// The parts of volume_kernel.hpp that all centres share.
template <class Real>
struct VolumeParts {
  Wendland air;
  Real air_factor; ///< 1 - keep, with the kernel's constant factor
  Real keep;
};

/// Returns psi / kernel_factor.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V air_weight(D d, Wendland air, V o) {
  return with_kernel(air, [&](auto kernel) HWY_ATTR { return weight<kernel.value>(d, o); });
}

/// Adds (A I + B u u^T) a for each place: A a + B (u.a) u.
template <bool has_air, class D, class V = hn::Vec<D>>
HWY_INLINE void add_volume_entry(D d, const VolumeParts<hn::TFromD<D>>& parts,
                                 const FieldEntry<hn::TFromD<D>>& entry,
                                 const Vectors3<V> (&places)[abreast],
                                 Vectors3<V> (&sums)[abreast]) {
  using Real = hn::TFromD<D>;
  const V one = hn::Set(d, Real(1));
  const V inverse = hn::Set(d, entry.inverse_radius);
  const Vectors3<V> a{hn::Set(d, entry.coefficient[0]), hn::Set(d, entry.coefficient[1]),
                      hn::Set(d, entry.coefficient[2])};
  for (std::size_t n = 0; n < abreast; ++n) {
    const Vectors3<V> way = relative_to(d, entry, places[n]);
    const V along = dot_product(way, a);
    const V t = hn::Mul(hn::Sqrt(dot_product(way, way)), inverse);
    const V o = hn::Max(hn::Sub(one, t), hn::Zero(d));
    const V o2 = hn::Mul(o, o);
    const V o4 = hn::Mul(o2, o2);
    const V linear = hn::NegMulAdd(hn::Set(d, Real(20)), t, hn::Set(d, Real(4)));
    V w = hn::Mul(hn::Mul(hn::Set(d, parts.keep), o4), hn::MulAdd(t, linear, one));
    if constexpr (has_air)
      w = hn::MulAdd(hn::Set(d, parts.air_factor), air_weight(d, parts.air, o), w);
    const V b = hn::Mul(hn::Mul(hn::Set(d, entry.inner), o4), along);
    sums[n].x = hn::MulAdd(w, a.x, hn::MulAdd(b, way.x, sums[n].x));
    sums[n].y = hn::MulAdd(w, a.y, hn::MulAdd(b, way.y, sums[n].y));
    sums[n].z = hn::MulAdd(w, a.z, hn::MulAdd(b, way.z, sums[n].z));
  }
}

/// Fields that keep the volume, which have no polynomial.
template <bool has_air, class Real>
struct VolumeDisplacement {
  VolumeParts<Real> parts;
  const FieldEntry<Real>* entries;
  const BlockPass& pass;

  HWY_INLINE void on_block(std::size_t block, const std::uint32_t* list, std::size_t size) {
    pass.reached[block] = size > 0 ? 1 : 0;
    if (size == 0) return;
    const hn::ScalableTag<Real> d;
    using V = hn::Vec<decltype(d)>;
    const VertexBlock& from = pass.from[block];
    const VertexBlock& base = pass.base == nullptr ? from : pass.base[block];
    for (std::size_t lane = 0; lane < block_size; lane += abreast * hn::Lanes(d)) {
      Vectors3<V> places[abreast];
      Vectors3<V> sums[abreast];
      load_places(d, from, lane, places);
      for (Vectors3<V>& sum : sums)
        sum = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
      for (std::size_t at = 0; at < size; ++at)
        add_volume_entry<has_air>(d, parts, entries[list[at]], places, sums);
      load_places(d, base, lane, places);
      for (std::size_t n = 0; n < abreast; ++n)
        places[n] = sum_of(places[n], sums[n]);
      store_places(d, places, pass.to[block], lane, false);
    }
  }
};

template <class Real>
void displace_keeping_volume(const FieldView& field, const FieldEntry<Real>* entries,
                             const BlockPass& pass) {
  const double air = 1.0 - field.keep_volume;
  const VolumeParts<Real> parts{field.kernel, static_cast<Real>(air * kernel_factor(field.kernel)),
                                static_cast<Real>(field.keep_volume)};
  if (air > 0.0) {
    VolumeDisplacement<true, Real> work{parts, entries, pass};
    for_each_block(field.centres, pass, work);
  } else {
    VolumeDisplacement<false, Real> work{parts, entries, pass};
    for_each_block(field.centres, pass, work);
  }
}

template <Wendland kernel, class Real>
struct Displacement {
  const FieldView& field;
  const FieldEntry<Real>* entries;
  const BlockPass& pass;
  bool streams;

  HWY_INLINE void on_block(std::size_t block, const std::uint32_t* list, std::size_t size) {
    const bool reached = size > 0 || field.polynomial != nullptr;
    pass.reached[block] = reached ? 1 : 0;
    if (!reached) return;
    const VertexBlock& from = pass.from[block];
    VertexBlock& to = pass.to[block];
    if (size == 1 && field.polynomial == nullptr)
      return displace_block_by_one<kernel>(entries[list[0]], from, to, streams);
    displace_block<kernel>(field, entries, list, size, from, to, streams);
  }
};

template <Wendland kernel, class Real>
void displace_blocks(const FieldView& field, const FieldEntry<Real>* entries,
                     const BlockPass& pass) {
  Displacement<kernel, Real> work{field, entries, pass, pass.large && pass.to != pass.from};
  for_each_block(field.centres, pass, work);
}

template <Wendland kernel>
void displace_with(const FieldView& field, const BlockPass& pass) {
  if (field.precise_entries != nullptr) {
    displace_blocks<kernel>(field, field.precise_entries, pass);
  } else {
    displace_blocks<kernel>(field, field.entries, pass);
  }
}

void displace_any(const FieldView& field, const BlockPass& pass) {
  if (field.keep_volume > 0.0) {
    if (field.precise_entries != nullptr)
      displace_keeping_volume(field, field.precise_entries, pass);
    else
      displace_keeping_volume(field, field.entries, pass);
    return;
  }
  with_kernel(field.kernel,
              [&](auto kernel) HWY_ATTR { displace_with<kernel.value>(field, pass); });
}

BlockBounds measure_block(const VertexBlock& block) {
  return vector_bounds(ListVectors(), block);
}

struct PairCount {
  std::size_t pairs = 0;

  HWY_INLINE void on_block(std::size_t, const std::uint32_t*, std::size_t size) { pairs += size; }
};

std::size_t count_listed(const FieldView& field, const BlockPass& pass) {
  PairCount work;
  for_each_block(field.centres, pass, work);
  return work.pairs;
}

using Probes = hn::CappedTag<double, probe_vector>;
using ProbeV = hn::Vec<Probes>;

/// Rows of a 3 by 3 matrix, or of a vector's three coordinates.
struct ProbePlace {
  ProbeV at[3];
  ProbeV moved[3];
  ProbeV jacobian[3][3];
};

HWY_INLINE void add_polynomial(Probes d, const Eigen::Matrix<double, 3, 4>& polynomial,
                               ProbePlace& place) {
  for (Eigen::Index row = 0; row < 3; ++row) {
    ProbeV sum = hn::Set(d, polynomial(row, 0));
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const ProbeV slope = hn::Set(d, polynomial(row, axis + 1));
      sum = hn::MulAdd(slope, place.at[axis], sum);
      place.jacobian[row][axis] = row == axis ? hn::Add(slope, hn::Set(d, 1.0)) : slope;
    }
    place.moved[row] = hn::Add(place.at[row], sum);
  }
}

template <Wendland kernel>
HWY_INLINE void add_centre(Probes d, const CsrbfField& field, Eigen::Index i, ProbePlace& place) {
  const ProbeV zero = hn::Zero(d);
  const double radius = field.radii[i];
  ProbeV offset[3];
  ProbeV squared = zero;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    offset[axis] = hn::Sub(place.at[axis], hn::Set(d, field.centres(axis, i)));
    squared = hn::MulAdd(offset[axis], offset[axis], squared);
  }
  if (hn::AllFalse(d, hn::Lt(squared, hn::Set(d, radius * radius)))) return;
  const ProbeV t = hn::Mul(hn::Sqrt(squared), hn::Set(d, 1.0 / radius));
  const ProbeV o = hn::Max(hn::Sub(hn::Set(d, 1.0), t), zero);
  const ProbeV psi = hn::Mul(hn::Set(d, kernel_factor(kernel)), weight<kernel>(d, o));
  const double factor = slope_factor(kernel) / (radius * radius);
  const ProbeV steep = hn::Mul(slope<kernel>(d, t, o), hn::Set(d, factor));
  for (ProbeV& coordinate : offset)
    coordinate = hn::Mul(steep, coordinate);
  for (Eigen::Index row = 0; row < 3; ++row) {
    const ProbeV coefficient = hn::Set(d, field.coefficients(row, i));
    place.moved[row] = hn::MulAdd(psi, coefficient, place.moved[row]);
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      place.jacobian[row][axis] = hn::MulAdd(coefficient, offset[axis], place.jacobian[row][axis]);
  }
}

HWY_INLINE ProbeV determinant(const ProbeV (&m)[3][3]) {
  const ProbeV first = hn::NegMulAdd(m[1][2], m[2][1], hn::Mul(m[1][1], m[2][2]));
  const ProbeV second = hn::NegMulAdd(m[1][0], m[2][2], hn::Mul(m[1][2], m[2][0]));
  const ProbeV third = hn::NegMulAdd(m[1][1], m[2][0], hn::Mul(m[1][0], m[2][1]));
  return hn::MulAdd(m[0][0], first, hn::MulAdd(m[0][1], second, hn::Mul(m[0][2], third)));
}

template <Wendland kernel>
double advance(const CsrbfField& field, const ProbeArrays& probes) {
  const Probes d;
  double* const coordinates[3] = {probes.x, probes.y, probes.z};
  ProbeV least = hn::Inf(d);
  for (std::size_t at = 0; at < probes.count; at += hn::Lanes(d)) {
    ProbePlace place;
    for (std::size_t axis = 0; axis < 3; ++axis)
      place.at[axis] = hn::LoadU(d, coordinates[axis] + at);
    add_polynomial(d, field.polynomial, place);
    for (Eigen::Index i = 0; i < field.centres.cols(); ++i)
      add_centre<kernel>(d, field, i, place);
    const ProbeV all = hn::Mul(hn::LoadU(d, probes.determinant + at), determinant(place.jacobian));
    hn::StoreU(all, d, probes.determinant + at);
    least = hn::Min(least, all);
    for (std::size_t axis = 0; axis < 3; ++axis)
      hn::StoreU(place.moved[axis], d, coordinates[axis] + at);
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

double advance_any(const CsrbfField& field, const ProbeArrays& probes) {
  return with_kernel(field.kernel,
                     [&](auto kernel) HWY_ATTR { return advance<kernel.value>(field, probes); });
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(displace_any);
HWY_EXPORT(measure_block);
HWY_EXPORT(count_listed);
HWY_EXPORT(advance_any);

void displace_pass(const FieldView& field, const BlockPass& pass) noexcept {
  HWY_DYNAMIC_DISPATCH(displace_any)(field, pass);
}

BlockBounds bounds_of(const VertexBlock& block) noexcept {
  return HWY_DYNAMIC_DISPATCH(measure_block)(block);
}

std::size_t count_pairs(const FieldView& field, const BlockPass& pass) noexcept {
  return HWY_DYNAMIC_DISPATCH(count_listed)(field, pass);
}

double advance_probes(const CsrbfField& field, const ProbeArrays& probes) noexcept {
  return HWY_DYNAMIC_DISPATCH(advance_any)(field, probes);
}

} // namespace nendo::deform
#endif
