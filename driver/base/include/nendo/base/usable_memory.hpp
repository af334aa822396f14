#pragma once
// How much memory there is for this program.

#include <cstddef>
#include <filesystem>

namespace nendo {

/// Bytes: the machine's, or less where a control group of this process (cgroup version 2: a
/// container, a service with MemoryMax=) may have less. Reads files; never fails.
std::size_t usable_memory();

/// The least memory.max of the group that `membership` names and of those above it, beneath the
/// file system that is mounted at `root`; as /proc/self/cgroup and /sys/fs/cgroup are. Without any
/// the greatest number there is.
std::size_t group_memory_limit(const std::filesystem::path& membership,
                               const std::filesystem::path& root);

} // namespace nendo
