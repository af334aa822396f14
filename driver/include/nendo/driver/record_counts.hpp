#pragma once
// What became of the records that a glove has sent, under one set of names for every summary: of a
// run, of a recording, on the screens, in text and in JSON. What is lost on the line and what is
// lost in the program have different remedies, so they never share a name.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/driver/glove.hpp>

namespace nendo::driver {

struct RecordCounts {
  std::uint64_t delivered = 0; ///< whole, valid records that arrived
  /// Known to have been sent, and not delivered; a glove without a clock cannot tell of any.
  std::uint64_t missed = 0;
  std::uint64_t refused = 0; ///< of the delivered ones: they found the ring of samples full
  /// Framed, but damaged. Where the glove has a clock, `missed` counts those that were records.
  std::uint64_t bad = 0;

  /// As far as the glove's clock tells.
  std::uint64_t sent() const noexcept { return delivered + missed; }
  friend bool operator==(const RecordCounts&, const RecordCounts&) = default;
};

RecordCounts counts_of(const GloveStats& stats) noexcept;
/// Returns what was counted since `earlier`.
RecordCounts since(const RecordCounts& earlier, const RecordCounts& now) noexcept;

/// Returns the counts with the names that they have in JSON: sent, delivered, missed, refused,
/// bad_records.
std::array<std::pair<std::string_view, std::uint64_t>, 5>
by_name(const RecordCounts& counts) noexcept;
/// Returns the same for people: "457 sent, 359 delivered, 98 missed, 0 refused, 0 bad records".
std::string in_words(const RecordCounts& counts);

} // namespace nendo::driver
