#include "transport/missing_node.hpp"

#include <cstdio>
#include <string_view>
#include <system_error>

#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

/// "c 188 0", as mknod wants it; nothing if the kernel has no such device.
std::optional<std::string> kernel_number(const std::string& path) {
  unsigned bus = 0;
  unsigned address = 0;
  if (std::sscanf(path.c_str(), "/dev/bus/usb/%3u/%3u", &bus, &address) == 2) {
    if (bus == 0 || address == 0) return std::nullopt;
    constexpr unsigned devices_a_bus = 128;
    return "c 189 " + std::to_string((bus - 1) * devices_a_bus + address - 1);
  }
  const fs::path port(path);
  if (port.parent_path() != "/dev" || !port.has_filename()) return std::nullopt;
  std::string number = read_line("/sys/class/tty" / port.filename() / "dev");
  const std::size_t colon = number.find(':');
  std::error_code ignored;
  if (colon == std::string::npos)
    return fs::exists("/sys/class/tty" / port.filename(), ignored) ? std::optional<std::string>("")
                                                                   : std::nullopt;
  number[colon] = ' ';
  return "c " + number;
}

/// The kind of container, as its maker marks it: "docker", "podman", "systemd-nspawn", "lxc", ...;
/// empty: none that is known.
std::string container_kind(const fs::path& root) {
  std::error_code ignored;
  if (fs::exists(root / ".dockerenv", ignored)) return "docker";
  if (fs::exists(root / "run/.containerenv", ignored)) return "podman";
  return read_line(root / "run/systemd/container");
}

} // namespace

std::optional<std::string> missing_node(const std::string& path, const fs::path& root) {
  std::error_code failed;
  if (fs::exists(fs::symlink_status(path, failed))) return std::nullopt;
  const auto number = kernel_number(path);
  if (!number) return std::nullopt;
  const std::string run = "--device=" + path;
  const std::string docker = "docker run " + run + " ...";
  const std::string podman = "podman run " + run + " --group-add keep-groups ...";
  const std::string nspawn =
      "systemd-nspawn --bind=" + path + " --property=DeviceAllow='" + path + " rw' ...";
  const std::string lxc = "lxc-device -n NAME add " + path;
  const std::string kind = container_kind(root);
  std::string hand_in;
  if (kind == "docker") hand_in = docker;
  if (kind == "podman") hand_in = podman;
  if (kind == "systemd-nspawn") hand_in = nspawn;
  if (kind == "lxc" || kind == "lxc-libvirt") hand_in = lxc;
  if (!hand_in.empty()) return "start the container with it, on the host: " + hand_in;
  const std::string make = number->empty() ? "" : "sudo mknod -m 660 " + path + " " + *number;
  return "in a container, hand it in from the host: " + docker + ", " + podman + ", " + nspawn +
         ", or " + lxc + (make.empty() ? "" : "; elsewhere, or with the right MKNOD: " + make);
}

} // namespace nendo::driver
