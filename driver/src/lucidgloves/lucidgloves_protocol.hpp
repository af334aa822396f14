#pragma once
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

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::driver::lucidgloves {

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

} // namespace nendo::driver::lucidgloves
