#include "bench/plane_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>

#include <nendo/base/usable_memory.hpp>

#include "cli/cli.hpp"

namespace nendo::bench {
namespace {

/// 0 if the kernel does not say.
std::size_t available_bytes() {
  std::ifstream lines("/proc/meminfo");
  std::string key;
  std::size_t kilobytes = 0;
  for (std::string unit; lines >> key >> kilobytes; std::getline(lines, unit))
    if (key == "MemAvailable:") return kilobytes * 1024;
  return 0;
}

} // namespace

bool has_memory_for_plane(int cells, const std::string& benchmark) {
  constexpr std::size_t bytes_a_vertex = 300; // most of it while vertices are put in order
  const auto side = static_cast<std::size_t>(cells) + 1;
  const std::size_t vertices = side * side;
  const bool has_memory = std::min(available_bytes(), usable_memory()) >= bytes_a_vertex * vertices;
  if (!has_memory)
    cli::note(benchmark + ": not enough free memory for " + std::to_string(vertices) + " vertices");
  return has_memory;
}

} // namespace nendo::bench
