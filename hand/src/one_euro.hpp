#pragma once
// What the 1-euro filters of angles and of poses share.

#include <algorithm>
#include <numbers>

namespace nendo::hand {

/// Returns an option of a filter, limited to a range. NaN becomes the lower limit.
inline double limited_option(double lower, double value, double upper) noexcept {
  return value > lower ? std::min(value, upper) : lower;
}
inline double limited_cutoff_hz(double cutoff_hz) noexcept {
  return limited_option(1e-3, cutoff_hz, 1e5);
}
inline double limited_beta(double beta) noexcept {
  return limited_option(0.0, beta, 1e5);
}

inline double time_constant_of(double cutoff_hz) noexcept {
  return 1.0 / (2.0 * std::numbers::pi * cutoff_hz);
}

} // namespace nendo::hand
