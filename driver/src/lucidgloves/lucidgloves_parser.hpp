#pragma once
// Splits the text stream of a LucidGlove into lines. It is pure (no I/O, clock, log or allocation),
// and bytes are not trusted. A piece of a line may look like a whole one, so everything before the
// first LF is skipped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "lucidgloves/lucidgloves_protocol.hpp"
#include "stream/findings.hpp"
#include "stream/stream_counters.hpp"

namespace nendo::driver::lucidgloves {

/// The values of one line. Fingers go from thumb to pinky.
struct Line {
  using Value = std::optional<std::uint16_t>;
  std::array<Value, fingers> curl;
  std::array<Value, fingers> splay;
  std::array<std::array<Value, joints>, fingers> joint; ///< of each finger, from the metacarpal out
  std::optional<std::uint32_t> firmware;
  std::optional<std::uint32_t> device;
  std::optional<std::uint32_t> hand;
  bool legacy = false;
  unsigned above_range = 0; ///< values that were, and are set to the range
  unsigned below_range = 0; ///< values that were negative, and are set to 0

  bool measures() const noexcept; ///< has a value of a finger
  bool informs() const noexcept;  ///< has a value of the glove itself
  bool is_whole() const noexcept; ///< has the curls of all fingers
};

/// Decodes one line without its end. Values above `range` become `range`, negative ones 0. Returns
/// nothing if the line violates the encoding, tells a value twice (as two lines that were joined
/// do), tells nothing of a hand, or holds a value farther from 0 than max_beyond_range beside
/// which others are missing (as two numbers that were joined are).
std::optional<Line> decode_line(std::string_view text, std::uint16_t range) noexcept;

/// What to do with the bytes before the first LF.
enum class FirstPiece : std::uint8_t {
  skip,
  take_if_whole, ///< Line::is_whole(): enough to know the glove by, but its first number may be cut
};

class Parser {
public:
  explicit Parser(std::uint16_t range, FirstPiece first = FirstPiece::skip) noexcept
      : range_(range), first_(first) {
    reset();
  }

  /// Takes the next bytes of the stream, cut anywhere, and hands each good line to `sink(const
  /// Line&)`. Lines that measure count as records; replies do not.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      const auto line = push_byte(byte);
      for (; bad_ > 0; --bad_)
        report(sink, BadRecord{});
      if (line) sink(*line);
    }
  }

  /// Drops the unfinished line. What follows is skipped up to the next line's beginning.
  void reset() noexcept;
  /// See StreamCounters::count_discarded.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Returns the bytes of the unfinished line, always less than max_line_bytes.
  std::size_t pending() const noexcept { return held_; }

private:
  enum class State : std::uint8_t { in_line, begin_unseen, first_piece, overlong };

  std::optional<Line> push_byte(std::byte byte) noexcept;
  std::optional<Line> end_line() noexcept;
  void discard_held() noexcept;
  void count_bad() noexcept { ++counters_.bad_records, ++bad_; }

  const std::uint16_t range_;
  const FirstPiece first_;
  State state_ = State::begin_unseen;
  std::array<char, max_line_bytes> line_{};
  std::size_t held_ = 0;
  unsigned bad_ = 0; ///< found by the last byte, not yet told
  StreamCounters counters_;
};

} // namespace nendo::driver::lucidgloves
