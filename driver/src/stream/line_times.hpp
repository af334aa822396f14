#pragma once
// When records were sent on a serial line, for devices without a clock.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::driver {

/// The arithmetic of a line that carries 10 bits per byte and records of one length. Pure.
class LineTimes {
public:
  LineTimes() = default;
  /// 0 is an unknown rate: records then follow each other without a pause.
  LineTimes(int baud, std::size_t record_bytes, double records_per_second) noexcept
      : byte_(from_seconds(10.0 / baud)), record_bytes_(record_bytes) {
    const auto record = byte_ * static_cast<std::int64_t>(record_bytes);
    if (records_per_second > 0.0)
      pause_ = std::max(from_seconds(1.0 / records_per_second) - record, HostClock::duration{});
  }

  /// Returns when the device began to send a record, after whose end `later_bytes` more had arrived
  /// by `arrival`. If several records arrive in one chunk, since the host or an adapter was held
  /// up, the device nevertheless sent them one per cycle.
  HostTime record_begin(HostTime arrival, std::uint64_t later_bytes) const noexcept {
    const auto bytes = static_cast<std::int64_t>(later_bytes + record_bytes_);
    const auto pauses =
        static_cast<std::int64_t>((later_bytes + record_bytes_ - 1) / record_bytes_);
    return arrival - bytes * byte_ - pauses * pause_;
  }

  /// Returns `time`, but not before the last result: a chunk can be late as a whole.
  HostTime in_order(HostTime time) noexcept { return last_ = std::max(last_, time); }

private:
  HostClock::duration byte_{};
  HostClock::duration pause_{}; ///< between the end of a record and the next one's begin
  std::size_t record_bytes_ = 1;
  HostTime last_{};
};

} // namespace nendo::driver
