#pragma once
// Counts of a device's delivered and lost records, with the same names in every summary: of a run,
// of a recording, on screens, in text and in JSON. Losses on the line and losses in the program
// have different remedies, so they have different names.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/driver/glove.hpp>

namespace nendo::driver {

struct RecordCounts {
  std::uint64_t delivered = 0; ///< complete, valid records that arrived
  std::uint64_t missed = 0;    ///< records known to be sent but not delivered

  std::uint64_t refused = 0; ///< delivered records refused by the full sample ring
  /// Framed but damaged data. If the glove has a clock, `missed` includes the records among them.
  std::uint64_t bad = 0;
  /// Out-of-range values in delivered records, clamped to the range.
  std::uint64_t clamped = 0;
  /// Whether losses can be counted. If not, sent() is unknown and `missed` is 0.
  bool counts_missed = true;

  /// Meaningful only if counts_missed.
  std::uint64_t sent() const noexcept { return delivered + missed; }
  friend bool operator==(const RecordCounts&, const RecordCounts&) = default;
};

NENDO_API RecordCounts counts_of(const StreamStats& stats) noexcept;
/// Returns `now` minus `earlier`.
NENDO_API RecordCounts since(const RecordCounts& earlier, const RecordCounts& now) noexcept;

/// Returns the counts with their names in JSON: sent, delivered, missed, refused, bad_records,
/// clamped_values. `sent` and `missed` have no value if unknown.
NENDO_API std::array<std::pair<std::string_view, std::optional<std::uint64_t>>, 6>
by_name(const RecordCounts& counts) noexcept;
/// Returns the counts as text: "457 sent, 359 delivered, 98 missed, 0 refused, 0 bad records". It
/// also states unknown losses, and omits zero clamped values.
NENDO_API std::string in_words(const RecordCounts& counts);

/// Returns "72.0 records per second of the 90.0 that were asked for" if losses cannot be counted
/// and the rate is lower than `asked_hz` (0: unknown) by 5 % or more; else an empty string.
NENDO_API std::string rate_shortfall(double asked_hz, const StreamStats& stats);

} // namespace nendo::driver
