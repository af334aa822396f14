#pragma once
// A sample of a tracker: the pose of one station (a receiver, a marker body), as the device reports
// it, with its times. `hand` turns it into a wrist's pose.

#include <array>
#include <chrono>
#include <cstdint>

#include <nendo/base/notifying_ring.hpp>
#include <nendo/base/units.hpp>

namespace nendo {

/// A pose in the tracker's own frame. Not checked: the numbers may be far off or not finite.
struct PoseSample {
  HostTime arrival{}; ///< when the record's last byte reached the host
  /// The best estimate of the time of measurement on the host's clock: the device's time stamp,
  /// mapped by an estimate of offset and drift, or `arrival` minus the known delays of device and
  /// line. Equals `arrival` if the driver knows neither.
  HostTime measured{};
  /// The device's own clock, from its own zero; if has_device_time.
  std::chrono::nanoseconds device_time{};
  std::uint64_t sequence = 0; ///< number of the record; also counts records that the ring refused
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{0, 0, 0, 1}; ///< a quaternion: station to tracker
  std::uint16_t station = 0;                   ///< the station's number, as the device counts
  char error = ' ';                            ///< the device's error letter; blank: none
  bool has_device_time = false;
  bool is_replayed = false; ///< `arrival` and `measured` are times of the replay
  /// The original `arrival` and `measured`; if is_replayed.
  HostTime recorded_arrival{};
  HostTime recorded_measured{};
};

/// Carries poses of one station from the tracker's reader thread to one consumer thread.
using PoseRing = NotifyingRing<PoseSample>;

} // namespace nendo
