#pragma once
// The pose in binary records of Polhemus' trackers.

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include <nendo/base/byte_reader.hpp>

#include "polhemus/pose_record.hpp"

namespace nendo::driver::polhemus {

/// Further away than any transmitter reaches: that of long range, 4.6 m. Chosen.
inline constexpr double max_coordinate_cm = 500.0;

/// Reads x, y, z in centimetres and a quaternion with its scalar first, as 32-bit floats. Returns
/// false if they are no pose in reach.
inline bool read_pose(ByteReader& reader, std::array<double, 3>& position_m,
                      std::array<double, 4>& turn_xyzw) noexcept {
  const auto next = [&] { return static_cast<double>(std::bit_cast<float>(reader.u32_le())); };
  bool good = true;
  for (double& coordinate_m : position_m) {
    const double coordinate_cm = next();
    good = good && std::abs(coordinate_cm) <= max_coordinate_cm; // false for NaN
    coordinate_m = coordinate_cm / 100.0;
  }
  double squares = 0.0;
  for (const std::size_t k : {3U, 0U, 1U, 2U}) {
    turn_xyzw[k] = next();
    squares += turn_xyzw[k] * turn_xyzw[k];
  }
  return good && std::abs(std::sqrt(squares) - 1.0) <= max_norm_error;
}

} // namespace nendo::driver::polhemus
