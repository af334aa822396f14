#pragma once
// What gloves and trackers have in common: the properties that a device reports, and the counts of
// its stream.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace nendo::driver {

/// A property that a device reports, e.g. {"firmware", "2.1"}. Names are stable, lower case with
/// underscores, and end with the unit, if any; values are one printable line.
struct DeviceFact {
  std::string name;
  std::string value;
};

/// The source of a device's samples.
enum class SourceKind : std::uint8_t {
  device,    ///< a glove on a hand, a tracker, or an emulated one at a port
  simulated, ///< made by this program
  recorded,  ///< read from a recording
};

/// The names of the kinds, in their order.
inline constexpr std::array<std::string_view, 3> source_kind_names{"device", "simulated",
                                                                   "recorded"};

/// Monotonic counts of a stream of bytes. bytes = record_bytes + discarded_bytes + a remainder
/// shorter than the longest record.
struct StreamCounters {
  std::uint64_t bytes = 0;           ///< bytes received from the device
  std::uint64_t record_bytes = 0;    ///< bytes of delivered records
  std::uint64_t discarded_bytes = 0; ///< bytes of noise, damaged records, replies
  std::uint64_t records = 0;         ///< delivered records: complete and valid
  std::uint64_t bad_records = 0;     ///< framed, with wrong length, header, checksum or content
  std::uint64_t implausible = 0;     ///< bad records with contradictory time stamp or status
  std::uint64_t missed = 0;    ///< sent, by its clock or count, not delivered; includes bad ones
  std::uint64_t too_fast = 0;  ///< delivered, but reported as off the sampling period (`es`)
  std::uint64_t unplugged = 0; ///< records that report no glove (`eg`); not delivered
  std::uint64_t clamped = 0;   ///< out-of-range values in delivered records, clamped to the range

  /// Adds bytes that other code read from the same stream and that were no records.
  void count_discarded(std::uint64_t count) noexcept {
    bytes += count;
    discarded_bytes += count;
  }
};

/// The counts since start(). If counts_missed, records sent = records + missed, once the next valid
/// record (with 12-bit records, the next two) has arrived.
struct StreamStats : StreamCounters {
  std::uint64_t ring_refused = 0; ///< samples refused by the full ring
  std::uint64_t silences = 0;     ///< times the stream stopped and was restarted
  std::uint64_t reopened = 0;     ///< times the device vanished and was reopened
  double rate_hz = 0.0;           ///< records per second over the last second or two; 0 at first
  bool counts_missed = false;     ///< its records allow counting `missed`
};

} // namespace nendo::driver
