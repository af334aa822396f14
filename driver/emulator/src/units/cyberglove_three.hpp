#pragma once
// The commands that only a CyberGlove III has. All begin with the digit 1. Only their forms are
// known, from programs that drive the glove. Comments in the .cpp file tell what was chosen beyond
// that.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "units/unit_message.hpp"

namespace nendo::emulator::unit {

inline constexpr Byte three_prefix = '1'; ///< and the header of a stream of 12-bit records

/// How 12-bit streams begin, end, and count.
enum class HiResForm : std::uint8_t {
  hardware,  ///< 1S is echoed without NUL, 0x03 is answered by itself, sub-frames count from 0
  terminated ///< both answers end in NUL as all others, and sub-frames count from 1
};

struct ThreeSettings {
  unsigned frames = 3;  ///< the base rate in units of 30 Hz
  unsigned divider = 1; ///< of the base rate, for the USB sink
  bool usb = true;      ///< the USB sink is on

  /// Returns the time between two 12-bit records, in 1/115200 s.
  std::uint64_t period_ticks() const noexcept;
};

/// Returns how many bytes the command has after its 1, as far as its first bytes (at least one)
/// tell; nothing if there is no such command.
std::optional<std::size_t> three_bytes(const Message& command);

/// Handles a complete command. S, which starts the stream, is left to the caller. Returns false,
/// and sets nothing, if a number is out of range.
bool apply(ThreeSettings& settings, const Message& command);

} // namespace nendo::emulator::unit
