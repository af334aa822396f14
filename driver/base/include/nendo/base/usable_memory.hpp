#pragma once
// The memory that this program may use.

#include <cstddef>
#include <filesystem>

#include <nendo/base/api.hpp>

namespace nendo {

/// Returns how many bytes of memory this process may use: the machine's memory, or less if a
/// control group of this process (cgroup version 2: a container, a service with MemoryMax=) has a
/// lower limit. It reads files, and it never fails.
NENDO_API std::size_t usable_memory();

/// Returns the least memory.max, in bytes, of the control group that the file `membership` names
/// and of the groups above it. `root` is where the control groups are mounted. Usually these are
/// /proc/self/cgroup and /sys/fs/cgroup. Returns the greatest std::size_t if there is no limit.
NENDO_API std::size_t group_memory_limit(const std::filesystem::path& membership,
                                         const std::filesystem::path& root);

} // namespace nendo
