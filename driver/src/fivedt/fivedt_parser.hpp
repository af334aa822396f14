#pragma once
// Splits the byte stream of a 5DT Data Glove 5 into samples, and finds the glove's answer to 'G'.
// It is pure (no I/O, clock, log or allocation), and bytes are not trusted. Nothing marks a
// sample's beginning for certain. So nine bytes are a sample if they begin with the header and
// their checksum fits; otherwise one byte is dropped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <nendo/driver/sample.hpp>

#include "stream/stream_parser.hpp"

namespace nendo::driver::fivedt {

// The serial protocol of the 5DT Data Glove 5. Each fact names who states it:
//   [V]  VRPN's driver, whose authors had the maker's manual    [J]  VR Juggler's driver
//   [M]  the maker's manual
//
// A sample [V, J]: 0x80, thumb, index, middle, ring, pinky, pitch, roll, checksum. Pitch and roll
// come from a tilt sensor on the back of the hand: they say how the hand is held in space, not how
// the wrist is bent, so they have no slot.
//
// Is that the order of a left glove, too? [V] and [J] take it for both hands. [M] reverses the
// fingers of left gloves, but only where it describes thresholds and gesture bits, which are not
// used here. One other driver reverses the sample as well. So thumb first is the default for both
// hands, and an option turns it for those left gloves that are otherwise.

inline constexpr int wired_baud = 19'200;   ///< 8N1 [V, J]
inline constexpr int wireless_baud = 9'600; ///< and then the glove hears nothing [V]

// Commands, one letter each.
inline constexpr char reset_command = 'A';       ///< ends a stream; answered by 0x55 [V]
inline constexpr char information_command = 'G'; ///< answered by information_bytes [V]
inline constexpr char stream_command = 'D';      ///< one sample after the other [V]

// A sample. Any byte of it may be 0x80. Some units send an extra 0x55 before or after it [V].
// Wireless ones send an extra byte with the hand; it is ignored, because [V] and [J] disagree
// on its bits.
inline constexpr std::byte header{0x80};          ///< [V, J]
inline constexpr std::size_t data_bytes = 7;      ///< five fingers, pitch, roll [V, J]
inline constexpr std::size_t sample_bytes = 9;    ///< with header and checksum [V, J]
inline constexpr std::size_t fingers = 5;         ///< 0 straight, 255 bent [V, J]
inline constexpr std::size_t max_extra_bytes = 1; ///< between two samples [V]
// The checksum is the exclusive or of the data [J]; VRPN does not look at it.

// The answer to 'G' [V].
inline constexpr std::size_t information_bytes = 32;
inline constexpr char information_mark[2] = {'B', 'R'}; ///< how it begins
inline constexpr std::size_t version_at = 2;            ///< two bytes: major, minor
inline constexpr std::size_t hand_at = 4;
inline constexpr std::uint8_t right_hand_bit = 0x01;
inline constexpr std::size_t abilities_at = 5;
inline constexpr std::uint8_t tilt_bit = 0x10; ///< pitch and roll are measured
inline constexpr std::size_t name_at = 16;     ///< text to the end, or to a NUL

struct Record {
  std::array<std::uint8_t, fingers> flexion{}; ///< thumb to little finger, 0 straight to 255 bent
};

/// Decodes nine bytes. Returns nothing if header or checksum are wrong.
std::optional<Record> decode_record(std::span<const std::byte, sample_bytes> frame) noexcept;

/// A damaged sample counts once as bad, even if many bytes are dropped before the next good one.
class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished sample. The next byte may come from anywhere in a sample.
  void reset() noexcept;

private:
  friend StreamParser;

  std::optional<Record> push_byte(std::byte byte) noexcept;
  void drop_first() noexcept;

  std::array<std::byte, sample_bytes> frame_{};
  bool in_step_ = false;  ///< the last sample was good, and no more than extra bytes came since
  std::size_t extra_ = 0; ///< bytes dropped since the last good sample, while in step
};

/// A glove's answer to the information command.
struct Information {
  Side side = Side::right;
  std::uint8_t version_major = 0;
  std::uint8_t version_minor = 0;
  bool tilt_sensor = false;
  std::string name; ///< printable, without blanks at its ends; may be empty
};

/// Returns nullopt if the answer does not begin as it must.
std::optional<Information> decode_information(std::span<const std::byte, information_bytes> answer);

/// Finds the answer in a glove's bytes, cut anywhere, after a sample or another answer.
class InformationFinder {
public:
  /// Takes the next bytes. Returns true once the whole answer was seen; later bytes are ignored.
  bool push(std::span<const std::byte> chunk) noexcept;
  std::span<const std::byte, information_bytes> answer() const noexcept { return answer_; }

private:
  std::array<std::byte, information_bytes> answer_{};
  std::size_t held_ = 0;
};

} // namespace nendo::driver::fivedt
