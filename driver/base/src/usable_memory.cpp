#include <nendo/base/usable_memory.hpp>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <unistd.h>

namespace nendo {
namespace {

constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

// "max" and what is no number are no limit.
std::size_t limit_in(const std::filesystem::path& file) {
  std::ifstream input(file);
  std::size_t bytes = 0;
  return input >> bytes ? bytes : no_limit;
}

// Of version 2's line, "0::/system.slice/nendo.service", the part after the colons.
std::filesystem::path group_in(const std::filesystem::path& membership) {
  std::ifstream input(membership);
  for (std::string line; std::getline(input, line);)
    if (line.starts_with("0::/")) return line.substr(4);
  return {};
}

} // namespace

std::size_t group_memory_limit(const std::filesystem::path& membership,
                               const std::filesystem::path& root) {
  std::filesystem::path group = root;
  std::size_t least = limit_in(group / "memory.max");
  for (const auto& part : group_in(membership)) {
    group /= part;
    least = std::min(least, limit_in(group / "memory.max"));
  }
  return least;
}

std::size_t usable_memory() {
  constexpr std::size_t unknown = std::size_t{2} << 30;
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  const std::size_t of_machine =
      pages > 0 && page_bytes > 0
          ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(page_bytes)
          : unknown;
  return std::min(of_machine, group_memory_limit("/proc/self/cgroup", "/sys/fs/cgroup"));
}

} // namespace nendo
