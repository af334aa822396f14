#pragma once
// FTDI adapters hold back replies that are shorter than a packet, for 16 ms by default. That is too
// long for a glove that is asked for each record at 100 Hz, and it adds jitter to a stream.

#include <chrono>
#include <optional>
#include <string>

namespace nendo::driver {

/// Returns the latency timer; nullopt if the port, a name like /dev/ttyUSB0 or a link to it, is not
/// an FTDI adapter's.
std::optional<std::chrono::milliseconds> ftdi_latency_timer(const std::string& port);

/// Sets the timer to the shortest time, 1 ms, if this user may do so: by default only root may, but
/// udev rules can change that. Returns the timer afterwards; nullopt as above. The change may stall
/// the adapter for a quarter of a second (linux-usb mailing list), so make it before a dialogue.
std::optional<std::chrono::milliseconds> shorten_ftdi_latency(const std::string& port);

} // namespace nendo::driver
