#pragma once
// Finds the programs that hold a device, as far as /proc shows them without opening the device.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/driver/devices.hpp>

namespace nendo::driver {

struct Holders {
  std::map<std::string, std::vector<DeviceHolder>> of; ///< the holders by device
  bool complete = true; ///< all processes could be inspected within the time
};

/// Returns the programs that hold these device nodes. It looks through all programs' open files,
/// for 0.5 s at most, and through the kernel's list of file locks, which also names the locks of
/// other users' programs.
Holders find_holders(const std::set<std::string>& devices);

/// Returns the first other program that holds this node, for the middle of a message: ", picocom
/// (pid 4711)". Empty if none can be seen.
std::string holder_of(const std::string& device);

/// A line of /proc/locks: which program locked which file.
struct FileLock {
  int pid = 0; ///< 0 or below: a program in another container
  unsigned major = 0;
  unsigned minor = 0;
  std::uint64_t inode = 0;
  friend bool operator==(const FileLock&, const FileLock&) = default;
};

/// Returns the locks in the text of /proc/locks. Lines that are not understood, and lines of
/// programs that wait for a lock, are left out.
std::vector<FileLock> parse_locks(std::string_view text);

} // namespace nendo::driver
