#include "simd/press_kernels.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/press_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PressTag = hn::CappedTag<double, press_lanes>;
using PressV = hn::Vec<PressTag>;

HWY_INLINE void fill_row(const PressArrays& arrays, std::size_t row, double inverse_radius) {
  const PressTag d;
  const PressV one = hn::Set(d, 1.0);
  const auto product_with = [&](const double* numbers, std::size_t at) HWY_ATTR {
    return hn::Mul(hn::Set(d, numbers[row]), hn::Load(d, numbers + at));
  };
  const auto way_from = [&](const double* places, std::size_t at) HWY_ATTR {
    return hn::Sub(hn::Load(d, places + at), hn::Set(d, places[row]));
  };
  double* const psis = arrays.psi + row * arrays.stride;
  double* const products = arrays.a + row * arrays.stride;
  for (std::size_t at = 0; at < arrays.stride; at += hn::Lanes(d)) {
    const PressV x = way_from(arrays.x, at);
    const PressV y = way_from(arrays.y, at);
    const PressV z = way_from(arrays.z, at);
    const PressV distance = hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
    const PressV t = hn::Min(hn::Mul(distance, hn::Set(d, inverse_radius)), one);
    const PressV o = hn::Sub(one, t);
    const PressV o2 = hn::Mul(o, o);
    const PressV psi = hn::Mul(hn::Mul(o2, o2), hn::MulAdd(hn::Set(d, 4.0), t, one));
    const PressV along =
        hn::Add(hn::Add(product_with(arrays.normal[0], at), product_with(arrays.normal[1], at)),
                product_with(arrays.normal[2], at));
    hn::Store(psi, d, psis + at);
    hn::Store(hn::Mul(psi, along), d, products + at);
  }
}

void fill_rows(const PressArrays& arrays, double radius, double ridge) {
  for (std::size_t row = 0; row < arrays.count; ++row) {
    fill_row(arrays, row, 1.0 / radius);
    arrays.a[row * arrays.stride + row] += ridge;
  }
}

HWY_INLINE void add_scaled(const double* row, double factor, std::size_t size, double* to) {
  const PressTag d;
  const PressV by = hn::Set(d, factor);
  for (std::size_t at = 0; at < size; at += hn::Lanes(d))
    hn::Store(hn::MulAdd(by, hn::Load(d, row + at), hn::Load(d, to + at)), d, to + at);
}

void sweep(const PressArrays& arrays, double* l, double* w, double least, int most_sweeps) {
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double largest = 0.0;
    for (std::size_t i = 0; i < arrays.count; ++i) {
      const double* const row = arrays.a + i * arrays.stride;
      const double after = std::max(0.0, l[i] - w[i] / row[i]);
      const double change = after - l[i];
      if (change == 0.0) continue;
      l[i] = after;
      add_scaled(row, change, arrays.stride, w);
      largest = std::max(largest, std::abs(change));
    }
    if (largest <= least) return;
  }
}

void add_rows(const PressArrays& arrays, const double* row, const std::array<double, 3>& change,
              const std::array<double*, 3>& to) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    add_scaled(row, change[axis], arrays.stride, to[axis]);
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(fill_rows);
HWY_EXPORT(sweep);
HWY_EXPORT(add_rows);

void fill_press_matrices(const PressArrays& arrays, double radius, double ridge) noexcept {
  HWY_DYNAMIC_DISPATCH(fill_rows)(arrays, radius, ridge);
}

void sweep_pressure(const PressArrays& arrays, double* l, double* w, double least,
                    int most_sweeps) noexcept {
  HWY_DYNAMIC_DISPATCH(sweep)(arrays, l, w, least, most_sweeps);
}

void add_row(const PressArrays& arrays, const double* row, const std::array<double, 3>& change,
             const std::array<double*, 3>& to) noexcept {
  HWY_DYNAMIC_DISPATCH(add_rows)(arrays, row, change, to);
}

} // namespace nendo::deform
#endif
