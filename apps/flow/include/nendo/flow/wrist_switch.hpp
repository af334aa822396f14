#pragma once
// Debounces the switch at the wrist, and defines its effects on a loop.

#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/driver/sample.hpp>

namespace nendo::flow {

/// What the switches of both hands do. Recordings keep the numbers, so new values are added at the
/// end.
enum class SwitchAction : std::uint8_t {
  none,   ///< nothing: the hands hold the model all the time
  grab,   ///< the hands hold the model while a switch is on
  commit, ///< turning one on makes the shape so far the rest shape, and the hands hold it again
  toggle, ///< turning one on has the hands release the model, the next time grab it again
  keep,   ///< turning one on keeps what was just done: a recorder's task, nothing to the loop
};

NENDO_API std::string_view name_of(SwitchAction action) noexcept;
NENDO_API std::optional<SwitchAction> switch_action_named(std::string_view name) noexcept;

/// Reads the switch's position sample by sample, and detects when it was really turned. It is pure:
/// no clock, no I/O.
class NENDO_API WristSwitchEdge {
public:
  /// A position counts once it has lasted this long and for at least two samples, because contacts
  /// bounce for some milliseconds, and a damaged status byte lasts one sample.
  static constexpr std::chrono::milliseconds settling_time{20};

  /// Returns true if the switch has just been turned on. The first known position is taken as the
  /// position from the start on. A sample without a position is ignored.
  bool turned_on(WristSwitch position, HostTime time) noexcept;
  bool is_on() const noexcept { return settled_ == WristSwitch::on; }

private:
  WristSwitch settled_ = WristSwitch::unknown;
  std::optional<HostTime> differs_since_;
};

} // namespace nendo::flow
