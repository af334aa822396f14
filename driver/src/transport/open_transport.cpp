#include "transport/open_transport.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <sys/stat.h>

#include "discovery/programs.hpp"
#include "transport/port_access.hpp"

namespace nendo::driver {

namespace fs = std::filesystem;

Error open_error(const std::string& path, int error_number) {
  switch (error_number) {
  case EACCES:
  case EPERM: {
    const PortAccess access = refused_access(path);
    return {Errc::no_permission, path + ": only " + access.who + " may open it; " + access.remedy};
  }
  case EBUSY:
  case EWOULDBLOCK:
    return {Errc::no_device, path + " is in use by another program" +
                                 holder_of(resolve_port(path)) + "; close that one first"};
  case ENOENT:
  case ENOTDIR:
    if (const auto remedy = missing_node(path)) {
      return {Errc::no_device,
              path + ": the kernel has this port, but there is no node for it here; " + *remedy};
    }
    return {Errc::no_device,
            path + ": no such port; is the glove plugged in? `nendo devices` lists the ports"};
  case ENOTTY:
  case EISDIR:
    return {Errc::no_device, path + " is not a serial port; `nendo devices` lists the ports"};
  default:
    return {Errc::no_device,
            path + " cannot be opened: " + std::generic_category().message(error_number)};
  }
}

bool is_serial_port(const std::string& path) {
  const fs::path port(path);
  std::error_code ignored;
  return port.parent_path() == "/dev" && port.has_filename() &&
         fs::exists("/sys/class/tty" / port.filename(), ignored);
}

std::string resolve_port(const std::string& path) {
  // Not realpath(): it would follow a port's own node too, where that is a link (as in test beds
  // that mock one).
  constexpr int max_links = 16;
  fs::path at = fs::path(path).lexically_normal();
  for (int links = 0; links < max_links && !is_serial_port(at.string()); ++links) {
    std::error_code not_a_link;
    const fs::path target = fs::read_symlink(at, not_a_link);
    if (not_a_link) break;
    at = (at.parent_path() / target).lexically_normal(); // an absolute target replaces the parent
  }
  return at.string();
}

Result<std::unique_ptr<Transport>> open_transport(const std::string& path, int baud) {
  const std::string port = resolve_port(path);
  struct stat status{};
  if (::stat(port.c_str(), &status) != 0) return open_error(path, errno);
  // Anything but a character device must not even be opened: a fifo would block, a file be locked.
  if (!S_ISCHR(status.st_mode)) return open_error(path, ENOTTY);
  return is_serial_port(port) ? open_serialport(port, baud) : open_termios(port);
}

} // namespace nendo::driver
