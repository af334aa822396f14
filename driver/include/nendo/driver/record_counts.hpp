#pragma once
// What became of the records that a glove has sent, under one set of names for every summary: of a
// run, of a recording, on the screens, in text and in JSON. What is lost on the line and what is
// lost in the program have different remedies, so they never share a name.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/driver/glove.hpp>

namespace nendo::driver {

struct RecordCounts {
  std::uint64_t delivered = 0; ///< whole, valid records that arrived
  std::uint64_t missed = 0;    ///< known to have been sent, and not delivered

  std::uint64_t refused = 0; ///< the delivered ones that found the ring of samples full
  /// Framed, but damaged. Where the glove has a clock, `missed` counts those that were records.
  std::uint64_t bad = 0;
  /// Values in delivered records that were out of their range, and count as its nearer end.
  std::uint64_t clamped = 0;
  /// Losses can be counted. Otherwise the number of sent records is unknown, and `missed` is 0.
  bool counts_missed = true;

  /// Meaningful only if counts_missed.
  std::uint64_t sent() const noexcept { return delivered + missed; }
  friend bool operator==(const RecordCounts&, const RecordCounts&) = default;
};

NENDO_API RecordCounts counts_of(const GloveStats& stats) noexcept;
/// Returns what was counted since `earlier`.
NENDO_API RecordCounts since(const RecordCounts& earlier, const RecordCounts& now) noexcept;

/// Returns the counts with the names that they have in JSON: sent, delivered, missed, refused,
/// bad_records, clamped_values. `sent` and `missed` have no value if unknown.
NENDO_API std::array<std::pair<std::string_view, std::optional<std::uint64_t>>, 6>
by_name(const RecordCounts& counts) noexcept;
/// Returns the same for people: "457 sent, 359 delivered, 98 missed, 0 refused, 0 bad records".
/// What is not known is said to be so, and clamped values are only named if there are some.
NENDO_API std::string in_words(const RecordCounts& counts);

/// Returns "72.0 records per second of the 90.0 that were asked for" where losses cannot be counted
/// and the rate shows that there are some, by 5 % or more; else an empty string.
NENDO_API std::string rate_shortfall(const GloveInfo& info, const GloveStats& stats);

} // namespace nendo::driver
