#pragma once
// Opens a Transport by its path, with libserialport for real ports and termios for
// pseudo-terminals, since Debian 12's libserialport 0.1.1 opens neither pseudo-terminals (they have
// no modem lines) nor symbolic links. Finds a port again when it comes back under another name: a
// glove that was plugged in as ttyUSB0 may return as ttyUSB1, and another adapter may have its
// name.

#include <functional>
#include <memory>
#include <string>

#include <nendo/base/result.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Opens a terminal as 8N1, raw, without flow control, for this program alone. Follows symbolic
/// links. `baud` is not set at a pseudo-terminal, where it has no meaning. Errors: no_device
/// (missing, not a terminal, in use), no_permission.
Result<std::unique_ptr<Transport>> open_transport(const std::string& path, int baud);

/// Returns true for /dev/<name> with an entry in /sys/class/tty, which is a real port that
/// libserialport can open.
bool is_serial_port(const std::string& path);

/// Follows symbolic links from `path` until `is_node` is true of a path, and returns the last one.
std::string follow_links(const std::string& path, bool (*is_node)(const std::string&));

/// Opens a real port by libserialport. `path` must be free of links.
Result<std::unique_ptr<Transport>> open_serialport(const std::string& path, int baud);
Result<std::unique_ptr<Transport>> open_termios(const std::string& path);
/// Takes over a descriptor. It must be open, non-blocking and, if it is a terminal, raw.
NENDO_API std::unique_ptr<Transport> transport_of(int fd);
/// Returns what a failed attempt to open or lock `path` means to the user.
Error open_error(const std::string& path, int error_number);

/// Returns a function that opens `path`, as open_transport() does and with its errors. The first
/// call that succeeds remembers the adapter: vendor, product, serial number and port, or where it
/// is plugged in if it has no serial number of its own. Later calls open the port that this adapter
/// has now; the error is no_device if there is none, also if another adapter has taken the name.
/// Ports without an adapter (UARTs, Bluetooth, pseudo-terminals) are opened by the same path each
/// time. An FTDI adapter's latency timer is shortened at each opening; if that is not permitted, a
/// line of log gives the remedy. Calls may block for half a second, and must not overlap.
std::function<Result<std::unique_ptr<Transport>>()> follow_port(std::string path, int baud);

} // namespace nendo::driver
