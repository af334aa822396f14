#pragma once
// The memory limit of this process.

#include <cstddef>
#include <filesystem>

#include <nendo/base/api.hpp>

namespace nendo {

/// Returns the bytes of memory that this process may use: the machine's memory, or the limit of a
/// control group of this process (cgroup v2: a container, a service with MemoryMax=) if that is
/// lower. Reads files; never fails.
NENDO_API std::size_t usable_memory();

/// Returns the lowest memory.max, in bytes, of the control group named in the file `membership`
/// (usually /proc/self/cgroup) and of its ancestors. `root` is the mount point of the groups
/// (usually /sys/fs/cgroup). Returns the maximum std::size_t if there is no limit.
NENDO_API std::size_t group_memory_limit(const std::filesystem::path& membership,
                                         const std::filesystem::path& root);

} // namespace nendo
