#pragma once
// The counts that every parser keeps.

#include <cstdint>

namespace nendo::driver {

/// All counts only grow. bytes = record_bytes + discarded_bytes + what the parser still holds,
/// which is less than one longest record.
struct StreamCounters {
  std::uint64_t bytes = 0;
  std::uint64_t record_bytes = 0;
  std::uint64_t discarded_bytes = 0;
  std::uint64_t records = 0;     ///< delivered
  std::uint64_t bad_records = 0; ///< frames that were no good record
  std::uint64_t implausible = 0; ///< bad ones that are well formed, but contradict earlier records
  std::uint64_t missed = 0;      ///< sent, by the device's clock, and not delivered
  std::uint64_t too_fast = 0;    ///< delivered, but not sampled when they should have been
  std::uint64_t unplugged = 0;   ///< whole records that say that no glove is plugged in
  std::uint64_t clamped = 0;     ///< values of delivered records that were out of their range

  /// Counts bytes that were read from the same stream elsewhere and that were no records.
  void count_discarded(std::uint64_t count) noexcept {
    bytes += count;
    discarded_bytes += count;
  }
};

} // namespace nendo::driver
