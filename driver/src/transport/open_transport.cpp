#include "transport/open_transport.hpp"

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include "discovery/programs.hpp"
#include "transport/port_access.hpp"
#include "transport/serial_ports.hpp"
#include "transport/usb_identity.hpp"

namespace nendo::driver {

namespace {

using namespace std::chrono_literals;

/// The same model with the same serial number, and the same one of its ports.
bool same_make(const UsbIdentity& a, const UsbIdentity& b) {
  return a.vendor_id == b.vendor_id && a.product_id == b.product_id && a.serial == b.serial &&
         a.interface_number == b.interface_number && a.port_number == b.port_number;
}

/// The ports of this machine that could be `adapter`'s, by their serial numbers.
std::vector<SerialPortInfo> ports_like(const UsbIdentity& adapter) {
  std::vector<SerialPortInfo> ports = list_serial_ports();
  std::erase_if(ports, [&](const SerialPortInfo& port) {
    return !port.usb || !same_make(*port.usb, adapter);
  });
  return ports;
}

class PortFollower {
public:
  PortFollower(std::string path, int baud) : path_(std::move(path)), baud_(baud) {}

  Result<std::unique_ptr<Transport>> open() {
    const std::optional<std::string> port = adapter_ ? find_adapter() : resolve_port(path_);
    if (!port) return Error{Errc::no_device, gone()};
    auto transport = open_transport(adapter_ ? *port : path_, baud_);
    if (!transport) return transport;
    // While it is open the kernel gives its name to no other port, so this adapter was opened.
    const auto opened = usb_identity_of("tty", *port);
    if (adapter_ && !(opened && is_adapter(*opened))) return Error{Errc::no_device, gone()};
    if (!adapter_ && opened) remember(*opened);
    shorten_latency(*port);
    return transport;
  }

private:
  void remember(const UsbIdentity& adapter) {
    adapter_ = adapter;
    // Some makers give all their adapters one serial number.
    by_place_ = adapter.serial.empty() || ports_like(adapter).size() > 1;
  }
  bool is_adapter(const UsbIdentity& usb) const {
    return same_make(usb, *adapter_) && (!by_place_ || usb.place == adapter_->place);
  }
  std::optional<std::string> find_adapter() const {
    for (const SerialPortInfo& port : ports_like(*adapter_)) {
      if (is_adapter(*port.usb)) return port.path;
    }
    return std::nullopt;
  }
  std::string gone() const {
    return path_ + ": its adapter (" +
           (by_place_ ? "USB place " + adapter_->place : "serial number " + adapter_->serial) +
           ") is not plugged in; another one under its name is not used";
  }
  void shorten_latency(const std::string& port) {
    const auto latency = shorten_ftdi_latency(port);
    if (!latency || *latency <= 1ms || std::exchange(warned_, true)) return;
    spdlog::warn("host: {} delays replies by {} ms (FTDI latency timer); shorten the delay: {}",
                 port, latency->count(), latency_timer_remedy(port));
  }

  const std::string path_;
  const int baud_;
  std::optional<UsbIdentity>
      adapter_; ///< the adapter, if the port has one, after the first opening
  bool by_place_ = false;
  bool warned_ = false;
};

} // namespace

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
            path + ": no such port; is the device plugged in? `nendo devices` lists the ports"};
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
  return follow_links(path, is_serial_port);
}

std::string follow_links(const std::string& path, bool (*is_node)(const std::string&)) {
  // Not realpath(): it would follow a device's own node too, where that is a link (as in test beds
  // that mock one).
  constexpr int max_links = 16;
  fs::path at = fs::path(path).lexically_normal();
  for (int links = 0; links < max_links && !is_node(at.string()); ++links) {
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

std::function<Result<std::unique_ptr<Transport>>()> follow_port(std::string path, int baud) {
  // Shared, because a std::function may be copied.
  return [follower = std::make_shared<PortFollower>(std::move(path), baud)] {
    return follower->open();
  };
}

} // namespace nendo::driver
