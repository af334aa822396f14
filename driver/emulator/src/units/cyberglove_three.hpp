#pragma once
// The commands that a CyberGlove III has and its predecessors have not: all begin with the digit 1.
// Only their forms are known, from programs that drive the glove; what was chosen beyond that is
// said in the source.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "units/unit_message.hpp"

namespace nendo::emulator::unit {

struct ThreeSettings {
  unsigned frames = 3;  ///< the base rate in units of 30 Hz
  unsigned divider = 1; ///< of the base rate, for the USB sink
  bool usb = true;      ///< the USB sink is on

  /// Between two 12-bit records, in 1/115200 s.
  std::uint64_t period_ticks() const noexcept;
};

/// How many bytes the command has after its 1, as far as its first bytes (at least one) tell;
/// empty: there is no such command.
std::optional<std::size_t> three_bytes(const Message& command);

/// Handles a complete command. S, which starts the stream, is left to the caller. False: a number
/// is out of range, nothing is set.
bool apply(ThreeSettings& settings, const Message& command);

} // namespace nendo::emulator::unit
