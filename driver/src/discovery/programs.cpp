#include "discovery/programs.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <sstream>
#include <system_error>

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <nendo/base/units.hpp>

#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

bool is_number(std::string_view text) {
  return !text.empty() && text.size() < 10 &&
         std::all_of(
             text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::vector<int> running_programs() {
  std::vector<int> pids;
  for (const std::string& name : names_in("/proc")) {
    if (is_number(name)) pids.push_back(std::stoi(name));
  }
  return pids;
}

std::string name_of_program(int pid) {
  const std::string name =
      pid > 0 ? read_line(fs::path("/proc") / std::to_string(pid) / "comm") : std::string{};
  return name.empty() ? "another user's program" : name;
}

void add_holder(std::vector<DeviceHolder>& holders, int pid) {
  const auto same = [&](const DeviceHolder& holder) { return holder.pid == pid; };
  if (std::any_of(holders.begin(), holders.end(), same)) return;
  holders.push_back({pid, name_of_program(pid)});
}

void look_into(int pid, const std::set<std::string>& devices, Holders& found) {
  const fs::path files = fs::path("/proc") / std::to_string(pid) / "fd";
  if (::access(files.c_str(), R_OK | X_OK) != 0) {
    found.complete = found.complete && errno == ENOENT; // it has ended, and holds nothing
    return;
  }
  for (const std::string& file : names_in(files)) {
    std::error_code closed;
    // The link's text only: to ask the file itself could block, on a dead network drive.
    const auto device = devices.find(fs::read_symlink(files / file, closed).string());
    if (device != devices.end()) add_holder(found.of[*device], pid);
  }
}

void add_lockers(const std::set<std::string>& devices, Holders& found) {
  const std::vector<FileLock> locks = parse_locks(read_text("/proc/locks"));
  for (const std::string& device : devices) {
    struct stat node{};
    if (::stat(device.c_str(), &node) != 0) continue;
    for (const FileLock& lock : locks) {
      if (lock.major == major(node.st_dev) && lock.minor == minor(node.st_dev) &&
          lock.inode == node.st_ino) {
        add_holder(found.of[device], std::max(lock.pid, 0));
      }
    }
  }
}

} // namespace

std::vector<FileLock> parse_locks(std::string_view text) {
  std::vector<FileLock> locks;
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    // "1: FLOCK  ADVISORY  WRITE 1234 00:06:1059 0 EOF"; who waits has "->" as the second word.
    std::istringstream words(line);
    std::string number, kind, strength, mode;
    FileLock lock;
    char colon = 0;
    char second_colon = 0;
    words >> number >> kind >> strength >> mode >> lock.pid;
    words >> std::hex >> lock.major >> colon >> lock.minor >> second_colon >> std::dec >>
        lock.inode;
    if (words && kind != "->" && colon == ':' && second_colon == ':') locks.push_back(lock);
  }
  return locks;
}

Holders find_holders(const std::set<std::string>& devices) {
  Holders found;
  if (devices.empty()) return found;
  const HostTime deadline = HostClock::now() + 500ms;
  for (const int pid : running_programs()) {
    if (HostClock::now() >= deadline) {
      found.complete = false;
      break;
    }
    look_into(pid, devices, found);
  }
  add_lockers(devices, found);
  return found;
}

std::string holder_of(const std::string& device) {
  const Holders found = find_holders({device});
  const auto holders = found.of.find(device);
  if (holders == found.of.end()) return {};
  for (const DeviceHolder& holder : holders->second)
    if (holder.pid > 0 && holder.pid != ::getpid())
      return ", " + holder.name + " (pid " + std::to_string(holder.pid) + ")";
  return {};
}

std::vector<std::string> running_port_grabbers() {
  constexpr std::array<std::string_view, 2> known{"ModemManager", "brltty"};
  std::set<std::string> running;
  for (const int pid : running_programs()) {
    const std::string name = name_of_program(pid);
    if (std::find(known.begin(), known.end(), name) != known.end()) running.insert(name);
  }
  return {running.begin(), running.end()};
}

} // namespace nendo::driver
