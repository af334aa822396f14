#include "transport/port_access.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <system_error>
#include <vector>

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

// Entries of users and groups longer than this are treated as unknown.
using EntryText = std::array<char, 16384>;

std::string group_name(gid_t id) {
  EntryText text;
  group entry{};
  group* found = nullptr;
  ::getgrgid_r(id, &entry, text.data(), text.size(), &found);
  return found != nullptr ? found->gr_name : std::to_string(id);
}

std::string user_name(uid_t id) {
  EntryText text;
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(id, &entry, text.data(), text.size(), &found);
  return found != nullptr ? found->pw_name : std::to_string(id);
}

/// True if the user was added to the group, whether or not this session knows it yet.
bool is_listed_in(gid_t id) {
  constexpr int max_groups = 1024;
  std::vector<gid_t> groups(max_groups);
  int count = max_groups;
  EntryText text;
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(::getuid(), &entry, text.data(), text.size(), &found);
  if (found == nullptr) return false;
  if (::getgrouplist(found->pw_name, found->pw_gid, groups.data(), &count) < 0) return false;
  groups.resize(static_cast<std::size_t>(count));
  return std::find(groups.begin(), groups.end(), id) != groups.end();
}

std::string join_group(gid_t id, const std::string& name) {
  // The commonest trap of all: a session keeps the groups that it began with.
  if (is_listed_in(id))
    return "log out and in again: you are in group " + name + " only since then";
  return "sudo usermod -aG " + name + " $USER, then log in again";
}

/// Arguments of mknod, "c 188 0"; nothing if the kernel has no such device.
std::optional<std::string> kernel_number(const std::string& path) {
  unsigned bus = 0;
  unsigned address = 0;
  if (std::sscanf(path.c_str(), "/dev/bus/usb/%3u/%3u", &bus, &address) == 2) {
    if (bus == 0 || address == 0) return std::nullopt;
    constexpr unsigned devices_per_bus = 128;
    return "c 189 " + std::to_string((bus - 1) * devices_per_bus + address - 1);
  }
  const fs::path node(path);
  const bool is_input = node.parent_path() == "/dev/input";
  if ((node.parent_path() != "/dev" && !is_input) || !node.has_filename()) return std::nullopt;
  const fs::path entry =
      fs::path(is_input ? "/sys/class/input" : "/sys/class/tty") / node.filename();
  std::string number = read_line(entry / "dev");
  const std::size_t colon = number.find(':');
  std::error_code ignored;
  if (colon == std::string::npos)
    return fs::exists(entry, ignored) ? std::optional<std::string>("") : std::nullopt;
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

PortAccess port_access(const std::string& path) {
  if (::access(path.c_str(), R_OK | W_OK) == 0) return {true, "you", ""};
  return refused_access(path);
}

PortAccess refused_access(const std::string& path) {
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) {
    if (auto remedy = missing_node(path)) return {false, "", *std::move(remedy), true};
    return {false, "", "plug it in again"};
  }
  constexpr mode_t group_both = S_IRGRP | S_IWGRP;
  constexpr mode_t owner_both = S_IRUSR | S_IWUSR;
  if ((status.st_mode & group_both) == group_both && status.st_gid != 0) {
    const std::string name = group_name(status.st_gid);
    return {false, "group " + name, join_group(status.st_gid, name)};
  }
  const bool owned = (status.st_mode & owner_both) == owner_both && status.st_uid != 0;
  const std::string owner = owned ? "user " + user_name(status.st_uid) : "root";
  return {false, owner, "sudo chown $USER " + path + ", which lasts until it is plugged in again"};
}

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
  std::string start;
  if (kind == "docker") start = docker;
  if (kind == "podman") start = podman;
  if (kind == "systemd-nspawn") start = nspawn;
  if (kind == "lxc" || kind == "lxc-libvirt") start = lxc;
  if (!start.empty()) return "start the container with it, on the host: " + start;
  const std::string make = number->empty() ? "" : "sudo mknod -m 660 " + path + " " + *number;
  return "in a container, pass it in from the host: " + docker + ", " + podman + ", " + nspawn +
         ", or " + lxc + (make.empty() ? "" : "; elsewhere, or with the right MKNOD: " + make);
}

} // namespace nendo::driver
