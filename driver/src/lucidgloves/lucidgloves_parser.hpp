#pragma once
// Splits the text stream of a LucidGlove into lines, and maps their values to sensor slots. It is
// pure (no I/O, clock, log or allocation), and bytes are not trusted. A piece of a line may look
// like a whole one, so everything before the first LF is skipped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/driver/sample.hpp>

#include "stream/stream_parser.hpp"

namespace nendo::driver::lucidgloves {

// The serial protocol of LucidGloves and everything else that speaks to OpenGloves: text lines.
// Each fact names who states it:
//   [F]  the LucidGloves firmware, up to commit 76472c7
//   [O]  the OpenGloves driver, the host's side
//   [S]  SenseShift's OpenGloves library, the only one with information replies
//   [?]  stated by no source, chosen here
//
// From the glove, one line per sample, ended by LF [F, O]:
//   A..E          curl of thumb, index, middle, ring, pinky: 0 straight .. `range` bent [F, O]
//   (AB)..(EB)    splay of a finger; half the range is straight ahead, the ends are 20 degrees to
//                 either side [O]; no source says which side is which
//   (AAA)..(EAD)  curl of one joint: finger, A, joint. A is the metacarpal bone's, B the knuckle's
//                 (the thumb's MCP), C the next (the thumb's IP), D the outermost [O]
//   F G P         joystick and trigger, analog [F]
//   H..O          buttons and gestures, without a number; there while pressed [F, O]
//   (ZV) (ZG) (ZH)  firmware version, device type, hand: 0 left, 1 right [S]
// Legacy firmwares: 13 numbers joined by &, the first five are the curls [F].

inline constexpr int baud = 115'200; ///< 8N1 [F, O]

inline constexpr std::size_t fingers = 5;
inline constexpr std::size_t joints = 4;
inline constexpr std::size_t legacy_values = 13;   ///< [F]
inline constexpr std::uint16_t esp32_range = 4095; ///< the largest number; 12 bits [F, O]
inline constexpr std::uint16_t avr_range = 1023;   ///< 10 bits [F]
/// A firmware that was built with CLAMP_ANALOG_MAP false sends what its calibration makes of a
/// finger that goes further than it did before: numbers above the range, and negative ones [F]. [O]
/// leaves that finger as it was, or refuses the line. Here the finger is at the end of its range,
/// where it really is. So far beyond it a number may also be two that ran into one [?].
inline constexpr std::int64_t max_beyond_range = 65'535;
inline constexpr std::size_t max_line_bytes = 256; ///< with LF; firmwares have 75 [F] to 256 [S]
inline constexpr std::uint32_t hand_left = 0;      ///< (ZH) [S]
inline constexpr std::uint32_t hand_right = 1;     ///< (ZH) [S]

// To the glove. Firmwares that do not know a command look in it for the letters A to E and a
// number: the first command has none, the second frees the thumb, unless they ignore lines of less
// than five characters, as today's do [F]. Legacy firmwares take any line for five brakes joined by
// &, and missing ones get undefined values [F]. So once such a firmware is recognised, it gets
// nothing but empty lines.
//
// With force feedback (USING_FORCE_FEEDBACK true, the default today) the firmware's loop sends a
// line and then waits for one: for Arduino's 1 s, or for as long as its version sets [F]. [O]
// writes a line for each one that it reads. A host that writes nothing gets one line per second, or
// one in all. So each line is answered: by the brakes, if anything has set them, or else by an
// empty line. No serial firmware of LucidGloves, of any year and in either encoding, decodes an
// empty line: it ends the wait and does nothing else [F, S].
//
// The firmware is unknown at first, so the glove's first whole line decides: a legacy one begins
// with a number, any other with a letter or a bracket. One that says nothing may be waiting: first
// an empty line ends that, and only if it does not help, the glove gets the command to stream.
inline constexpr std::string_view ask_information = "\nZ\n"; ///< answered by (ZV) (ZG) (ZH) [S]; LF
                                                             ///< ends what another host left
inline constexpr std::byte line_end{'\n'};
inline constexpr std::string_view empty_line = "\n";
inline constexpr std::string_view start_streaming = "(ZA)\n"; ///< where it was stopped by (ZZ) [S]
// Brakes: A%dB%dC%dD%dE%d\n, 0 free to `max_resistance` locked [F, O].
inline constexpr std::uint16_t max_resistance = 1000;

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
