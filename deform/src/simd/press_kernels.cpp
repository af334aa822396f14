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

void sweep(const PressArrays& arrays, double* l, double* w, double least, int max_sweeps) {
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
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

using SlopeTag = hn::CappedTag<float, 8>; // about as many cells as a function reaches in a row

/// |psi'| = 20 t (1 - t)^3 is the steepest at 1/4. All of a cell is within half its diagonal.
HWY_INLINE void add_row_of_slopes(const SlopeCells& cells, float along, float across_squared,
                                  float reach, float coefficient, float* sums) {
  const SlopeTag d;
  const auto one = hn::Set(d, 1.0F);
  const float inverse = 1.0F / cells.radius;
  const auto half = hn::Set(d, reach * inverse - 1.0F);
  const float widest = std::sqrt(reach * reach - across_squared) / cells.size;
  const float middle = along / cells.size - 0.5F; // in cells
  const auto last = static_cast<float>(cells.counts[0]) - 1.0F;
  const auto begin = static_cast<std::size_t>(std::clamp(middle - widest, 0.0F, last));
  const auto end = static_cast<std::size_t>(std::clamp(middle + widest + 1.0F, 0.0F, last));
  for (std::size_t at = begin / hn::Lanes(d) * hn::Lanes(d); at <= end; at += hn::Lanes(d)) {
    const auto x = hn::Mul(hn::Sub(hn::Iota(d, static_cast<float>(at)), hn::Set(d, middle)),
                           hn::Set(d, cells.size));
    const auto distance = hn::Sqrt(hn::MulAdd(x, x, hn::Set(d, across_squared)));
    const auto t = hn::Mul(distance, hn::Set(d, inverse));
    const auto least = hn::Sub(t, half);
    const auto steepest =
        hn::Min(hn::Min(hn::Max(hn::Set(d, 0.25F), least), hn::Add(t, half)), one);
    const auto left = hn::Sub(one, steepest);
    const auto slope = hn::Mul(hn::Mul(hn::Set(d, 20.0F * coefficient), steepest),
                               hn::Mul(left, hn::Mul(left, left)));
    hn::Store(hn::Add(hn::Load(d, sums + at), slope), d, sums + at);
  }
}

float steepest_of_cells(const SlopeCells& cells) {
  const SlopeTag d;
  auto steepest = hn::Zero(d);
  for (std::size_t layer = 0; layer < cells.counts[2]; ++layer)
    for (std::size_t row = 0; row < cells.counts[1]; ++row) {
      const float* const sums = cells.sums + (layer * slope_cells + row) * slope_cells;
      for (std::size_t at = 0; at < cells.counts[0]; at += hn::Lanes(d))
        steepest = hn::Max(steepest, hn::Load(d, sums + at));
    }
  return hn::GetLane(hn::MaxOfLanes(d, steepest));
}

void add_slopes_to_cells(const SlopeCells& cells, const std::array<float, 3>& centre,
                         float coefficient) {
  const float reach = cells.radius + 0.8661F * cells.size;
  const auto from = [&](std::size_t axis, std::size_t cell) HWY_ATTR {
    return (static_cast<float>(cell) + 0.5F) * cells.size - centre[axis];
  };
  for (std::size_t layer = 0; layer < cells.counts[2]; ++layer) {
    const float z = from(2, layer);
    if (std::abs(z) >= reach) continue;
    for (std::size_t row = 0; row < cells.counts[1]; ++row) {
      const float y = from(1, row);
      const float across_squared = y * y + z * z;
      if (across_squared < reach * reach)
        add_row_of_slopes(cells, centre[0], across_squared, reach, coefficient,
                          cells.sums + (layer * slope_cells + row) * slope_cells);
    }
  }
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(add_slopes_to_cells);
HWY_EXPORT(steepest_of_cells);
HWY_EXPORT(fill_rows);
HWY_EXPORT(sweep);
HWY_EXPORT(add_rows);

void fill_press_matrices(const PressArrays& arrays, double radius, double ridge) noexcept {
  HWY_DYNAMIC_DISPATCH(fill_rows)(arrays, radius, ridge);
}

void sweep_pressure(const PressArrays& arrays, double* l, double* w, double least,
                    int max_sweeps) noexcept {
  HWY_DYNAMIC_DISPATCH(sweep)(arrays, l, w, least, max_sweeps);
}

void add_row(const PressArrays& arrays, const double* row, const std::array<double, 3>& change,
             const std::array<double*, 3>& to) noexcept {
  HWY_DYNAMIC_DISPATCH(add_rows)(arrays, row, change, to);
}

void add_slopes(const SlopeCells& cells, const std::array<float, 3>& centre,
                float coefficient) noexcept {
  HWY_DYNAMIC_DISPATCH(add_slopes_to_cells)(cells, centre, coefficient);
}

float steepest_slope(const SlopeCells& cells) noexcept {
  return HWY_DYNAMIC_DISPATCH(steepest_of_cells)(cells);
}

} // namespace nendo::deform
#endif
