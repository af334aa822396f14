#pragma once
// Colours of files, which are encoded by sRGB's curve (IEC 61966-2-1), and linear ones.

#include <cmath>

namespace nendo::deform {

inline float linear_of(float encoded) noexcept {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

inline float encoded_of(float linear) noexcept {
  return linear <= 0.0031308F ? linear * 12.92F : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

} // namespace nendo::deform
