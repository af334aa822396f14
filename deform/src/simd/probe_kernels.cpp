#include "simd/probe_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/probe_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
  switch (field.kernel) {
  case Wendland::c0:
    return advance<Wendland::c0>(field, probes);
  case Wendland::c2:
    return advance<Wendland::c2>(field, probes);
  case Wendland::c4:
    return advance<Wendland::c4>(field, probes);
  case Wendland::c6:
    break;
  }
  return advance<Wendland::c6>(field, probes);
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(advance_any);

double advance_probes(const CsrbfField& field, const ProbeArrays& probes) noexcept {
  return HWY_DYNAMIC_DISPATCH(advance_any)(field, probes);
}

} // namespace nendo::deform
#endif
