#include "cli/processors.hpp"

#include <cstddef>

#include <sched.h>

namespace nendo::cli {

Result<TwoProcessors> two_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) < 2)
    return Error{Errc::failed,
                 "needs two processors, and this process may use only one; see taskset(1)"};
  TwoProcessors processors{-1, -1};
  for (int n = 0; processors.second < 0; ++n) {
    if (!CPU_ISSET(static_cast<std::size_t>(n), &allowed)) continue;
    (processors.first < 0 ? processors.first : processors.second) = n;
  }
  return processors;
}

} // namespace nendo::cli
