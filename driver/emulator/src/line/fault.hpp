#pragma once
// Faults by name, and the grammar that they are written in:
//   NAME=RATE%               by chance
//   NAME@TIME[+TIME][=VALUE] once, at a time since the emulator was started, for so long
// with TIME like 5s or 250ms.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "units/emulated_unit.hpp"

namespace nendo::emulator {

enum class FaultKind : std::uint8_t {
  drop,    ///< a byte vanishes; the rate is per byte
  flip,    ///< a bit of a byte is turned over; per byte
  insert,  ///< a random byte comes before a byte; per byte
  lose,    ///< a whole record vanishes; per record
  burst,   ///< 1 to 64 random bytes come before a record; per record
  silence, ///< nothing arrives
  junk,    ///< what a modem probe leaves on the line
  unplug,  ///< the terminal vanishes; another one comes, under the link or `value`
  eg,      ///< the glove is pulled out of the unit
  swap,    ///< another glove is plugged in: `value` is 18, 22, left or right
  restart, ///< the unit's power fails for a moment
  stick,   ///< a sensor stops: `value` is its name or slot, and a count after a colon
  press,   ///< no fault: the switch at the wrist is pressed
  error,   ///< a tracker's station reports an error: `value` is its letter, or STATION:LETTER
};
inline constexpr std::size_t fault_kinds = 14;

struct Fault {
  FaultKind kind = FaultKind::drop;
  double rate = 0.0; ///< probability, for faults by chance: more than 0, at most 1; otherwise 0
  std::chrono::nanoseconds at{};
  std::chrono::nanoseconds lasting{};
  std::string value = {};
};

std::string_view name_of(FaultKind kind) noexcept;
/// Returns the event at the unit that the fault causes when it begins or is over. Returns nothing
/// if it is a fault of the line or the terminal.
std::optional<Incident> incident_of(const Fault& fault, bool over);

/// Parses a fault. Error: usage, with the form that the fault should have.
Result<Fault> parse_fault(std::string_view text);
/// Parses all faults. Error: usage, also for two rates of one kind.
Result<std::vector<Fault>> parse_faults(const std::vector<std::string>& strings);

} // namespace nendo::emulator
