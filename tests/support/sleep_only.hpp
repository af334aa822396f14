#pragma once
// A thread that may only sleep: the kernel stops its other system calls, and they are counted.

#include <cstdint>

namespace nendo::test {

/// From now on the calling thread's system calls are counted and not done, except clock_nanosleep,
/// getrusage (by which a test counts page faults), the return from a signal handler, and exit. The
/// thread has to end in end_thread(). Returns false if this kernel has no seccomp.
bool allow_sleep_only() noexcept;

/// The number of the calling thread's system calls that were stopped so far, and the last of them.
struct StoppedCalls {
  std::uint64_t count = 0;
  int last = -1;
};
StoppedCalls stopped_calls() noexcept;

/// Ends the calling thread at once, because an ordinary end makes system calls. Destructors do not
/// run.
[[noreturn]] void end_thread() noexcept;

} // namespace nendo::test
