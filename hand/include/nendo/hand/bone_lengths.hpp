#pragma once
// The bones of one wearer's hand, as a ruler or a scan gives them.

#include <array>

#include <nendo/base/result.hpp>

namespace nendo::hand {

/// Lengths in metres. A bone runs from joint to joint, a distal bone from its joint to the tip of
/// the finger.
struct NENDO_API BoneLengths {
  static constexpr double min_m = 0.001;
  static constexpr double max_m = 0.200;

  std::array<double, 3> thumb_m{}; ///< metacarpal, proximal, distal
  /// Index, middle, ring, little: metacarpal, proximal, intermediate, distal.
  std::array<std::array<double, 4>, 4> fingers_m{};

  /// Fails with bad_input, naming the bone, if a length is not a number from min_m to max_m.
  Result<void> check() const;
};

} // namespace nendo::hand
