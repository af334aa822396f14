#pragma once
// Splits the text stream of a LucidGlove into lines, and maps their values to sensor slots. It is
// pure (no I/O, clock, log or allocation), and bytes are not trusted. A piece of a line may look
// like a whole one, so everything before the first LF is skipped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <nendo/driver/sample.hpp>

#include "lucidgloves/lucidgloves_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::lucidgloves {

/// The values of one line. Fingers go from thumb to little finger.
struct Line {
  using Value = std::optional<std::uint16_t>;
  std::array<Value, fingers> curl;
  std::array<Value, fingers> splay;
  std::array<std::array<Value, joints>, fingers> joint; ///< per finger, from the metacarpal out
  std::optional<std::uint32_t> firmware;
  std::optional<std::uint32_t> device;
  std::optional<std::uint32_t> hand;
  bool legacy = false;
  unsigned above_range = 0; ///< values above the range, which are set to it
  unsigned below_range = 0; ///< negative values, which are set to 0

  bool measures() const noexcept; ///< has a value of a finger
  bool informs() const noexcept;  ///< has a value of the glove itself
  bool is_whole() const noexcept; ///< has the curls of all fingers
};

/// Decodes one line without its end. Values above `range` become `range`, negative ones 0. Returns
/// nothing if the line violates the encoding, has a value twice (as two joined lines do), has no
/// value of a hand, or holds a value farther from 0 than max_beyond_range while others
/// are missing (as in two joined numbers).
std::optional<Line> decode_line(std::string_view text, std::uint16_t range) noexcept;

/// Sets a sample's `raw` and `present` from a line's values:
/// * joints B, C, D of a finger are MCP, PIP, DIP; of the thumb MCP and IP. The metacarpal (A) has
///   no slot.
/// * the curl of a whole finger counts as its MCP, if the line has no value for that.
/// * the thumb's splay is its abduction.
/// * the fingers' splays become the angle between neighbours, which is what the slots mean: twice
///   their difference, at most `range`. So `range` is the 20 degrees to which a splay goes, about
///   what a spread hand reaches. Its sign is lost, since no source defines it.
void fill_slots(const Line& line, std::uint16_t range, GloveSample& sample) noexcept;

/// What to do with the bytes before the first LF.
enum class FirstPiece : std::uint8_t {
  skip,
  take_if_whole, ///< Line::is_whole(): enough to know the glove by, but its first number may be cut
};

/// Lines that measure count as records; replies do not.
class Parser : public StreamParser<Parser> {
public:
  explicit Parser(std::uint16_t range, FirstPiece first = FirstPiece::skip) noexcept
      : range_(range), first_(first) {
    reset();
  }

  /// Drops the unfinished line. What follows is skipped up to the next line's beginning.
  void reset() noexcept;

private:
  friend StreamParser;

  enum class State : std::uint8_t { in_line, begin_unseen, first_piece, overlong };

  std::optional<Line> push_byte(std::byte byte) noexcept;
  std::optional<Line> end_line() noexcept;

  const std::uint16_t range_;
  const FirstPiece first_;
  State state_ = State::begin_unseen;
  std::array<char, max_line_bytes> line_{};
};

} // namespace nendo::driver::lucidgloves
