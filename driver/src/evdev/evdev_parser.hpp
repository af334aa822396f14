#pragma once
// Splits what a node /dev/input/event* sends into events: one `struct input_event` after the other
// (linux/input.h, and Documentation/input/input.rst of the kernel). It is pure (no I/O, clock, log
// or allocation), and bytes are not trusted.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

#include <linux/input.h>

#include "stream/stream_parser.hpp"

namespace nendo::driver::evdev {

/// An event without its time, which the kernel sets by a clock that a user can change.
struct Event {
  std::uint16_t type = 0; ///< EV_SYN, EV_KEY, EV_REL, EV_ABS
  std::uint16_t code = 0; ///< the axis or button
  std::int32_t value = 0;
};

inline constexpr std::size_t event_bytes = sizeof(input_event);

/// The kernel sends whole events, so nothing marks where one begins. Each event counts as a record.
class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished event. The next byte begins one.
  void reset() noexcept { discard_held(); }

private:
  friend StreamParser;

  std::optional<Event> push_byte(std::byte byte) noexcept {
    frame_[held_++] = byte;
    if (held_ < event_bytes) return std::nullopt;
    input_event event{};
    std::memcpy(&event, frame_.data(), event_bytes);
    accept_held();
    return Event{event.type, event.code, event.value};
  }

  std::array<std::byte, event_bytes> frame_{};
};

} // namespace nendo::driver::evdev
