#pragma once
// The serial protocol of LucidGloves and everything else that speaks to OpenGloves: text lines.
// Each fact names who states it:
//   [F]  the LucidGloves firmware        [O]  the OpenGloves driver, the host's side
//   [S]  SenseShift's OpenGloves library, the only one with information replies
//
// From the glove, one line a sample, ended by LF [F, O]:
//   A..E          curl of thumb, index, middle, ring, pinky: 0 straight .. `range` bent [F, O]
//   (AB)..(EB)    splay of a finger; half the range is straight ahead, the ends are 20 degrees to
//                 either side [O]; which side is which, nobody says
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
inline constexpr std::size_t legacy_values = 13;    ///< [F]
inline constexpr std::uint16_t esp32_range = 4095;  ///< the largest number; 12 bits [F, O]
inline constexpr std::uint16_t avr_range = 1023;    ///< 10 bits [F]
inline constexpr std::size_t most_line_bytes = 256; ///< with LF; firmwares have 75 [F] to 256 [S]
inline constexpr std::uint32_t hand_left = 0;       ///< (ZH) [S]
inline constexpr std::uint32_t hand_right = 1;      ///< (ZH) [S]

// To the glove. Firmwares that do not know a command look in it for the letters A to E and a
// number: the first command has none, the second frees the thumb [F]. Legacy firmwares take any
// line for five brakes joined by &, and missing ones get undefined values [F]. So once such a
// firmware is recognised, nothing is sent to it.
inline constexpr std::string_view ask_information = "\nZ\n"; ///< answered by (ZV) (ZG) (ZH) [S]; LF
                                                             ///< ends what another host left
inline constexpr std::string_view start_streaming = "(ZA)\n"; ///< where it was stopped by (ZZ) [S]
// Brakes: A%dB%dC%dD%dE%d\n, 0 free to `most_resistance` locked [F, O].
inline constexpr std::uint16_t most_resistance = 1000;

} // namespace nendo::driver::lucidgloves
