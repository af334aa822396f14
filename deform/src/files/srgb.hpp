#pragma once
// Colours of files, which are encoded by sRGB's curve (IEC 61966-2-1), and linear ones.

#include <cmath>

namespace nendo::deform {

// In double, so that the float is the same from every machine's pow().
inline float linear_of(float encoded) noexcept {
  const auto value = static_cast<double>(encoded);
  return static_cast<float>(value <= 0.04045 ? value / 12.92
                                             : std::pow((value + 0.055) / 1.055, 2.4));
}

inline float encoded_of(float linear) noexcept {
  const auto value = static_cast<double>(linear);
  return static_cast<float>(value <= 0.0031308 ? value * 12.92
                                               : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055);
}

} // namespace nendo::deform
