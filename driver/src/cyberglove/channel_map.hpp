#pragma once
// Maps each value of a record to its sensor slot. The map is computed from what the glove says of
// itself, and not from a table for gloves of 18 or 22 sensors, because the program that used the
// glove last may have changed its masks.

#include <array>
#include <cstddef>
#include <cstdint>

#include "cyberglove/cyberglove_protocol.hpp"

namespace nendo::driver::cyberglove {

struct ChannelMap {
  std::array<std::uint8_t, max_values> slot{}; ///< of value k
  std::size_t count = 0;                       ///< values in a record

  constexpr SensorMask sensors() const noexcept {
    SensorMask mask;
    for (std::size_t k = 0; k < count; ++k)
      mask.bits |= 1U << slot[k];
    return mask;
  }
  friend constexpr bool operator==(const ChannelMap&, const ChannelMap&) = default;
};

/// Returns the map of the first `most` sensors that are both built in and wanted.
constexpr ChannelMap make_channel_map(SensorMask hardware, SensorMask software,
                                      std::size_t most) noexcept {
  ChannelMap map;
  for (std::uint8_t slot = 0; slot < sensor_slots && map.count < most; ++slot) {
    if (((hardware.bits & software.bits) >> slot & 1U) != 0) map.slot[map.count++] = slot;
  }
  return map;
}

/// High-resolution records do not depend on masks. They always carry the 22 values of the full
/// glove.
inline constexpr ChannelMap hi_res_channels =
    make_channel_map(sensors_22, sensors_22, hi_res_values);

} // namespace nendo::driver::cyberglove
