#pragma once
// Sine and cosine by their series: mathematical libraries differ in the last bit, and with it in
// pixels; additions and products do not.

#include <cmath>
#include <numbers>

namespace nendo::viewer {

/// To 1e-15 for angles up to some turns.
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

} // namespace nendo::viewer
