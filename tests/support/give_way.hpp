#pragma once
// For tests that keep all processors busy, as pictures without a graphics card do.

#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

namespace nendo::test {

/// Lets this process, and all that it starts, run behind everything else. The scheduler weighs
/// sessions before it looks at niceness (autogroups, sched(7)), so it gets a session of its own: in
/// that of other tests it would delay the bytes of their emulated ports.
inline void give_way() {
  ::setsid();
  std::ofstream("/proc/self/autogroup") << "19"; // not every kernel has it
  ::setpriority(PRIO_PROCESS, 0, 19);
}

} // namespace nendo::test
