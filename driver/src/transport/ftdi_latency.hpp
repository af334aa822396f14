#pragma once
// FTDI adapters keep replies shorter than a packet back, 16 ms by default, for more to come. A
// glove that is asked for each record at 100 Hz cannot live with that; its streaming suffers as
// jitter.

#include <chrono>
#include <optional>
#include <string>

namespace nendo::driver {

/// nullopt if the port, a name like /dev/ttyUSB0 or a link to it, is not an FTDI adapter's.
std::optional<std::chrono::milliseconds> ftdi_latency_timer(const std::string& port);

/// Sets it to the shortest, 1 ms, where this user may: by default only root may, udev rules may
/// change that. Returns what it is afterwards; nullopt as above. The switch may stall the adapter
/// for a quarter of a second (linux-usb mailing list), so it is for the time before a dialogue.
std::optional<std::chrono::milliseconds> shorten_ftdi_latency(const std::string& port);

} // namespace nendo::driver
