#pragma once
// Computes sine and cosine by their series. Mathematical libraries differ in the last bit of these
// functions, which can change pixels. Additions and products do not differ.

#include <cmath>
#include <numbers>

namespace nendo::render {

/// Is exact to 1e-15 for angles up to a few turns.
inline double exact_sine(double angle_rad) noexcept {
  constexpr double turn = 2.0 * std::numbers::pi;
  const double x = angle_rad - turn * std::floor(angle_rad / turn + 0.5);
  double term = x;
  double sum = x;
  for (int n = 1; n <= 14; ++n) {
    term *= -x * x / ((2 * n) * (2 * n + 1));
    sum += term;
  }
  return sum;
}
inline double exact_cosine(double angle_rad) noexcept {
  return exact_sine(angle_rad + std::numbers::pi / 2);
}

} // namespace nendo::render
