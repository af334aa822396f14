#pragma once
// The bones of one wearer's hand, as a ruler or a scan gives them.

#include <array>

#include <nendo/base/result.hpp>

namespace nendo::hand {

/// Metres. Bones run from joint to joint; the distal ones to the tip of the finger.
struct BoneLengths {
  static constexpr double least_m = 0.001;
  static constexpr double most_m = 0.200;

  std::array<double, 3> thumb_m{}; ///< metacarpal, proximal, distal
  /// Index, middle, ring, little: metacarpal, proximal, intermediate, distal.
  std::array<std::array<double, 4>, 4> fingers_m{};

  /// Error: a length that is not a number from least_m to most_m, with the bone's name.
  Result<void> check() const;
};

} // namespace nendo::hand
