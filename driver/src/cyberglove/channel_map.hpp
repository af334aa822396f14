#pragma once
// Which sensor slot each value of a record belongs to. Computed from what the glove says of itself,
// never from a table for "the" 18- or 22-sensor glove: masks can be set, and cut, by whoever used
// it last.

#include <array>
#include <cstddef>
#include <cstdint>

#include "cyberglove/cyberglove_protocol.hpp"

namespace nendo::driver::cyberglove {

struct ChannelMap {
  std::array<std::uint8_t, most_values> slot{}; ///< of value k
  std::size_t count = 0;                        ///< values in a record

  constexpr SensorMask sensors() const noexcept {
    SensorMask mask;
    for (std::size_t k = 0; k < count; ++k)
      mask.bits |= 1U << slot[k];
    return mask;
  }
  friend constexpr bool operator==(const ChannelMap&, const ChannelMap&) = default;
};

/// The first `most` of the sensors that are both built in and wanted.
constexpr ChannelMap make_channel_map(SensorMask hardware, SensorMask software,
                                      std::size_t most) noexcept {
  ChannelMap map;
  for (std::uint8_t slot = 0; slot < sensor_slots && map.count < most; ++slot) {
    if (((hardware.bits & software.bits) >> slot & 1U) != 0) map.slot[map.count++] = slot;
  }
  return map;
}

/// High-resolution records know no masks: they always carry the 22 values of the full glove.
inline constexpr ChannelMap hi_res_channels =
    make_channel_map(sensors_22, sensors_22, hi_res_values);

} // namespace nendo::driver::cyberglove
